#include "scenarios/assimilation/compared_curves.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("assimilation/compared_curves") {
    TEST_CASE("measured, DEM only and fused keep words, styles and order in every picture, also "
              "when one of them is missing") {
        const std::vector<TriaxialPoint> points(3);
        const auto q = curves_of(1e-3, &TriaxialPoint::deviatoric_stress);
        const std::vector<TriaxialPoint>* const missing = nullptr;
        for (const auto* dem_only : {&points, missing}) {
            const auto curves = compared_curves({&points, dem_only, &points}, q);
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
        std::vector<TriaxialPoint> points(802);
        for (std::size_t k = 0; k < points.size(); ++k)
            points[k].axial_strain = 1e-4 * static_cast<double>(k);
        const auto curves =
            compared_curves({.measured = &points}, curves_of(1, &TriaxialPoint::deviatoric_stress));
        CHECK(curves[0].x.size() >= 100);
        CHECK(curves[0].x.size() <= 103);
        CHECK(curves[0].x.front() == 0);
        CHECK(curves[0].x.back() == doctest::Approx(8.01));
    }
}
