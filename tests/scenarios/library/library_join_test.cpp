#include "engine/errors.hpp"
#include "scenarios/library/library_join.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("library/library_join") {
    TEST_CASE("the specimens of a second library follow those of the first, and the ranges include "
              "both") {
        SpecimenLibrary library = testing::synthetic_library(6, 1),
                        other = testing::synthetic_library(4, 2);
        library.settings.emplace_back("lowest_porosity", "0.36");
        library.settings.emplace_back("highest_porosity", "0.42");
        other.settings.emplace_back("lowest_porosity", "0.315");
        other.settings.emplace_back("highest_porosity", "0.36");
        library.given_up = {7};
        other.given_up = {5};
        join(library, other, "other.h5");
        REQUIRE(library.specimens.size() == 10);
        CHECK(library.specimens[6].number == 8); // 7 numbers were taken
        CHECK(library.specimens[6].seed == other.specimens[0].seed);
        CHECK(library.specimens[9].tests[1].q == other.specimens[3].tests[1].q);
        CHECK(library.given_up == std::vector<std::uint64_t>{7, 12});
        CHECK(std::get<std::string>(library.settings[2].value) == "0.315");
        CHECK(std::get<std::string>(library.settings[3].value) == "0.42");
    }

    TEST_CASE("libraries of other rocks, pressures or with the same packings are not joined") {
        const SpecimenLibrary first = testing::synthetic_library(6, 1);
        const auto message = [&](const SpecimenLibrary& other) {
            SpecimenLibrary library = first;
            return message_of<InputError>([&] { join(library, other, "other.h5"); });
        };
        CHECK(message(testing::synthetic_library(6, 2)).empty());
        CHECK(message(first).find("in both") != std::string::npos);
        SpecimenLibrary other = testing::synthetic_library(6, 2);
        other.settings[1].value = std::string("arema_3");
        CHECK(message(other).find("grading arema_4") != std::string::npos);
        other = testing::synthetic_library(6, 2);
        other.pressures[1] = 120e3;
        CHECK(message(other).find("pressures") != std::string::npos);
    }
}
