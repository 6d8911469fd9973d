#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/library/material_estimate.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

SpecimenLibrary library_of(std::size_t specimens) {
    SpecimenLibrary library = testing::synthetic_library(specimens, 1);
    library.settings.emplace_back("clump_stiffness_N_per_m", "6.3e+07");
    return library;
}

/// A specimen of the library, measured at its second pressure up to a strain.
TestOfMaterial test_of(const SpecimenLibrary& library, std::size_t specimen, double strain) {
    TestOfMaterial test{{}, library.pressures[1], 0.39, 1};
    const LibraryTest& from = library.specimens[specimen].tests[1];
    for (std::size_t k = 0; k < library.axis.count; ++k) {
        if (library.axis.strain(k) > strain * (1 + 1e-9)) break;
        const auto row = test.measured.add_row();
        row[quantity::axial_strain] = library.axis.strain(k);
        row[quantity::deviatoric_stress] = double{from.q[k]};
        row[quantity::volumetric_strain] = double{from.volume[k]};
    }
    return test;
}

} // namespace

TEST_SUITE("library/material_estimate") {
    TEST_CASE("the card of a test holds the true friction in its band, and other pressures are "
              "predicted") {
        const SpecimenLibrary library = library_of(60), truths = testing::synthetic_library(60, 6);
        int inside = 0, q_inside = 0;
        for (std::size_t k = 0; k < truths.specimens.size(); ++k) {
            const MaterialEstimate e = estimate_material(library, test_of(truths, k, 0.02));
            const double friction = truths.specimens[k].rocks.friction;
            inside += e.card.friction.low < friction && friction < e.card.friction.high ? 1 : 0;
            REQUIRE(e.tests.size() == 2);
            CHECK(e.tests[0].pressure == 55e3);
            const double q = double{truths.specimens[k].tests[0].q[60]};
            const TestCurves::Column& predicted =
                e.tests[0].predicted.curves.column(quantity::deviatoric_stress);
            q_inside += predicted.low[60] < q && q < predicted.high[60] ? 1 : 0;
            CHECK(e.card.friction.value / friction == about(1).epsilon(0.5));
        }
        CHECK(inside >= 48); // of 60, 54 are expected; the binomial deviation is 2.3
        CHECK(q_inside >= 46);
    }

    TEST_CASE("a test at a pressure between those of the library is interpolated, and one outside "
              "is refused") {
        SpecimenLibrary library = library_of(10);
        CHECK(add_pressure(library, 110.5e3) == 1);
        CHECK(library.pressures.size() == 2);
        REQUIRE(add_pressure(library, 77.7817e3) == 2); // geometric mean: half way
        const auto& tests = library.specimens[3].tests;
        CHECK(double{tests[2].q[20]} ==
              about(std::sqrt(double{tests[0].q[20]} * double{tests[1].q[20]})).epsilon(1e-5));
        CHECK(double{tests[2].volume[20]} ==
              about((double{tests[0].volume[20]} + double{tests[1].volume[20]}) / 2).epsilon(1e-5));
        const std::string message =
            message_of<InputError>([&] { (void)add_pressure(library, 200e3); });
        CHECK(message.starts_with("--pressure: expected 55000 to 110000 Pa"));
    }

    TEST_CASE("further measurements are ranked by what they would tell of friction") {
        const SpecimenLibrary library = library_of(40);
        TestOfMaterial test = test_of(library, 3, 0.01);
        test.core_porosity = 0;
        for (double& v : test.measured[quantity::volumetric_strain]) v = std::nan("");
        const MaterialEstimate e = estimate_material(library, test);
        CHECK_FALSE(e.used.volume);
        REQUIRE(e.further_tests.size() == 1 + 2 + 3 + 4); // volume, porosity, three strains, four
        CHECK(e.further_tests[0].measured);
        for (std::size_t k = 2; k < e.further_tests.size(); ++k)
            CHECK(e.further_tests[k].ln_friction >= e.further_tests[k - 1].ln_friction);
        // nothing else in these curves tells friction from the strength of the packing, 0.1
        CHECK(e.further_tests[0].ln_friction == about(0.1).epsilon(0.3));
        CHECK(e.further_tests[1].ln_friction < 1.02 * e.further_tests[0].ln_friction);
        const TemporaryDirectory folder;
        write_further_tests(folder / "further.csv", e);
        CHECK(std::ranges::count(read_whole(folder / "further.csv"), '\n') == 12);
    }

    TEST_CASE("a test far from the library has wide bands and a note") {
        const SpecimenLibrary library = library_of(40);
        TestOfMaterial test = test_of(library, 3, 0.01);
        const MaterialEstimate near = estimate_material(library, test);
        for (double& q : test.measured[quantity::deviatoric_stress]) q *= 8;
        test.core_porosity = 0.5;
        const MaterialEstimate far = estimate_material(library, test);
        CHECK(near.notes.empty());
        CHECK(far.notes.size() == 2);
        CHECK(far.distance > 2);
        CHECK(std::log(far.card.friction.high / far.card.friction.low) >
              2 * std::log(near.card.friction.high / near.card.friction.low));
    }

    TEST_CASE("tests that cannot be used are refused by name") {
        const SpecimenLibrary library = library_of(20);
        const auto message = [&](const TestOfMaterial& test) {
            return message_of<InputError>([&] { (void)estimate_material(library, test); });
        };
        CHECK(message(test_of(library, 0, 0.04)).empty());
        CHECK(message(test_of(library, 0, 0.001)).find("at least 0.003") != std::string::npos);
        TestOfMaterial test = test_of(library, 0, 0.04);
        for (double& q : test.measured[quantity::deviatoric_stress]) q *= 1e-3;
        CHECK(message(test).find("another unit?") != std::string::npos);
        test = test_of(library, 0, 0.04);
        const auto leave_out = [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k)
                test.measured[quantity::deviatoric_stress][k] = std::nan("");
        };
        leave_out(10, 13);
        CHECK(message(test).empty()); // as far apart as records of laboratories
        leave_out(13, 17);
        CHECK(message(test).find("gaps") != std::string::npos);
        test = test_of(library, 0, 0.04);
        test.pressure = 20e3;
        CHECK(message(test).starts_with("--pressure"));
    }
}
