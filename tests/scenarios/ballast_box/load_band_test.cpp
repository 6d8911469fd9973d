#include "scenarios/ballast_box/load_band.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

TEST_SUITE("ballast_box/load_band") {
    TEST_CASE("the band grows with the speed and with the fourth root of the support") {
        const RailOnTies rails{
            .bending = 1.58e7, .tie_support = 30e6, .spacing = 0.15, .tie_weight = 0};
        const double slow = load_band(20, rails), fast = load_band(40, rails);
        CHECK(fast == about(2 * slow).epsilon(0.03));
        RailOnTies stiff = rails;
        stiff.tie_support *= 16;
        CHECK(load_band(20, stiff) == about(2 * slow).epsilon(0.05));
        MESSAGE(slow, " Hz at 20 m/s");
    }

    TEST_CASE("many close ties have the band of Winkler's foundation") {
        // the load on a tie is proportional to the deflection exp(-b|x|) (cos b|x| + sin b|x|), of
        // which the transform is 8 b^3 / (4 b^4 + q^4), q = 2 pi f / v
        const RailOnTies rails{
            .bending = 1.58e7, .tie_support = 30e6, .spacing = 0.15, .tie_weight = 0};
        const double b = rails.wave_number(), v = 20;
        double all = 0, below = 0, band = 0;
        const auto density = [&](double q) {
            return std::pow(q * q / (4 * std::pow(b, 4) + std::pow(q, 4)), 2);
        };
        constexpr double dq = 1e-3, most = 100;
        for (double q = 0.5 * dq; q < most; q += dq) all += density(q) * dq;
        all += 1 / (3 * std::pow(most, 3));
        for (double q = 0.5 * dq; below < 0.99 * all; q += dq) {
            below += density(q) * dq;
            band = v * q / (2 * 3.14159265358979);
        }
        CHECK(load_band(v, rails) == about(band).epsilon(0.03));
    }
}
