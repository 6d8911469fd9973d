#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/specimens/material_card_file.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("specimens/material_card_file") {
    TEST_CASE("a card that was written is read") {
        const TemporaryDirectory folder;
        const MaterialCard card{{0.7, 0.5, 0.9}, {6.3e7, 4e7, 9e7}, {0.38, 0.36, 0.4}};
        write_material_card(folder / "card.csv", card);
        const MaterialCard read = read_material_card(folder / "card.csv");
        CHECK(read.friction.value == about(0.7).epsilon(1e-5));
        CHECK(read.friction.high == about(0.9).epsilon(1e-5));
        CHECK(read.clump_stiffness.low == about(4e7).epsilon(1e-5));
        CHECK(read.core_porosity.value == about(0.38).epsilon(1e-5));
    }

    TEST_CASE("a file that is no card is refused with its name and line") {
        const TemporaryDirectory folder;
        const auto message = [&](const std::string& text) {
            write_whole(folder / "card.csv", text);
            return message_of<InputError>([&] { (void)read_material_card(folder / "card.csv"); });
        };
        const std::string names =
            "friction,friction_low,friction_high,clump_stiffness_N_per_m,"
            "clump_stiffness_low_N_per_m,clump_stiffness_high_N_per_m,core_porosity,"
            "core_porosity_low,core_porosity_high\n";
        CHECK(message(names + "0.7,0.5,0.9,6e7,4e7,9e7,0.38,0.36,0.4\n").empty());
        CHECK(message(names).find("found 0 rows") != std::string::npos);
        CHECK(message("friction\n0.7\n").find("friction_low") != std::string::npos);
        CHECK(message(names + "-0.7,0.5,0.9,6e7,4e7,9e7,0.38,0.36,0.4\n")
                  .find("card.csv:2: friction: expected a number above 0") != std::string::npos);
        CHECK(message(names + "-,0.5,0.9,6e7,4e7,9e7,0.38,0.36,0.4\n").find("friction") !=
              std::string::npos);
    }
}
