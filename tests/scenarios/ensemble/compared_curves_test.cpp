#include "scenarios/ensemble/compared_curves.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("ensemble/compared_curves") {
    TEST_CASE("measured, DEM only and fused keep words, styles and order in every picture, also "
              "when one of them is missing") {
        TestCurves three;
        for (int k = 0; k < 3; ++k) three.add_row();
        const auto q = curves_of(quantity::deviatoric_stress);
        const TestCurves* const missing = nullptr;
        for (const auto* dem_only : {static_cast<const TestCurves*>(&three), missing}) {
            const auto curves = compared_curves({&three, dem_only, &three}, q);
            REQUIRE(curves.size() == 3); // a missing curve still takes its colour
            CHECK(curves[0].label == "measured");
            CHECK(curves[0].style == Curve::Style::points);
            CHECK(curves[1].label == "DEM only");
            CHECK(curves[1].style == Curve::Style::dashed);
            CHECK(curves[1].x.size() == (dem_only != nullptr ? 3 : 0));
            CHECK(curves[2].label == "fused");
            CHECK(curves[2].style == Curve::Style::line);
            CHECK(curves[2].y.size() == 3);
        }
    }

    TEST_CASE("of many measured points about a hundred are drawn, with the first and the last") {
        TestCurves measured;
        for (int k = 0; k < 802; ++k) measured.add_row()[quantity::axial_strain] = 1e-4 * k;
        const auto curves =
            compared_curves({.measured = &measured}, curves_of(quantity::deviatoric_stress));
        CHECK(curves[0].x.size() >= 100);
        CHECK(curves[0].x.size() <= 103);
        CHECK(curves[0].x.front() == 0);
        CHECK(curves[0].x.back() == doctest::Approx(8.01));
    }
}
