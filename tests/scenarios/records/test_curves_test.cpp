#include "engine/errors.hpp"
#include "scenarios/records/test_curves.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <type_traits>

using namespace bris;

namespace {

TestCurves curves_of_strain(std::initializer_list<double> strains) {
    TestCurves curves;
    for (const double strain : strains) {
        const auto row = curves.add_row();
        row[quantity::axial_strain] = strain;
        row[quantity::deviatoric_stress] = 1e7 * strain;
    }
    return curves;
}

} // namespace

TEST_SUITE("records/test_curves") {
    TEST_CASE("a column has a number for each row, NaN where none was given, and one that nobody "
              "gave is not there") {
        TestCurves curves = curves_of_strain({0, 0.01, 0.02});
        curves.add_row().part(quantity::ring_radius, 1) = 0.1;
        const TestCurves& read = curves;
        CHECK(read.rings() == 1);
        CHECK(std::isnan(read.column(quantity::ring_radius, 1).values[2]));
        CHECK(read.column(quantity::ring_radius, 1).values[3] == 0.1);
        CHECK_THROWS_AS((void)read[quantity::boundary_work], std::out_of_range);
        CHECK(title_of(quantity::ring_radius, 1) == "ring_2_radius_m");
        CHECK(title_of(quantity::deviatoric_stress, 0, "_low") == "deviatoric_stress_low_Pa");
    }

    TEST_CASE("rows are chosen with the band of a prediction") {
        TestCurves curves = curves_of_strain({0, 0.01, 0.02});
        curves.column(quantity::deviatoric_stress).low = {1, 2, 3};
        curves.column(quantity::deviatoric_stress).high = {4, 5, 6};
        const TestCurves some = curves.up_to(0.01);
        CHECK(some.size() == 2);
        CHECK(some.column(quantity::deviatoric_stress).high == std::vector<double>{4, 5});
    }

    TEST_CASE("curves are looked up by strain only where it grows") {
        const TestCurves curves = curves_of_strain({0, 0.01, 0.02});
        const MonotonicStage stage(curves);
        CHECK(stage.nearest(0.0102, 1e-3) == 1);
        CHECK_FALSE(stage.nearest(0.015, 1e-3));
        CHECK(stage.value_at(quantity::deviatoric_stress, 0.015, 0.02) == doctest::Approx(1.5e5));
        CHECK(std::isnan(stage.value_at(quantity::deviatoric_stress, 0.015, 0.002)));
        const TestCurves unloaded = curves_of_strain({0, 0.01, 0.005});
        CHECK_THROWS_AS(MonotonicStage{unloaded}, InputError);
    }

    TEST_CASE(
        "predicted curves are not taken for measured ones, and an archive keeps all numbers") {
        CHECK_FALSE(std::is_convertible_v<TestCurves, MeasuredCurves>);
        TestCurves curves = curves_of_strain({0, 0.01});
        for (std::size_t r = 0; r < 2; ++r)
            curves.column(quantity::ring_radius, r).values = {0.1, 0.2};
        Archive archive;
        save_curves(archive, "run", curves);
        const TestCurves back = load_curves(archive, "run");
        CHECK(back[quantity::deviatoric_stress] == curves[quantity::deviatoric_stress]);
        CHECK(back[quantity::steps] == std::vector<double>{0, 0});
        REQUIRE(back.rings() == 2);
        CHECK(back.ring(1) == curves.ring(1));
    }
}
