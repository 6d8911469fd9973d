#include "engine/errors.hpp"
#include "systems/fusion/sensor_filter.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("fusion/sensor_filter") {
    TEST_CASE("between samples position and attitude become uncertain as their random walks, and "
              "velocities stay as certain") {
        SensorFilter filter({.position = 1e-3,
                             .velocity = 0,
                             .attitude = 0.02,
                             .angular_velocity = 0,
                             .acceleration_density = 0,
                             .angular_acceleration_density = 0,
                             .drift = 1e-5,
                             .turning = 0.1});
        (void)filter.update({.time = 3, .state = {}},
                            {}); // the first sample begins with the given deviations
        CHECK(filter.covariance()(0, 0) == about(1e-6).epsilon(1e-12));
        (void)filter.update({.time = 3.5, .state = {}}, {});
        const Matrix covariance = filter.covariance();
        for (int k = 0; k < 3; ++k) {
            CHECK(covariance(k, k) == about(1e-6 + 0.5 * 1e-5).epsilon(1e-12));
            CHECK(covariance(3 + k, 3 + k) == 0);
            CHECK(covariance(6 + k, 6 + k) == about(4e-4 + 0.5 * 0.1).epsilon(1e-12));
            CHECK(covariance(9 + k, 9 + k) == 0);
        }
    }

    TEST_CASE("after a withheld part of a correction the next correction has the right size") {
        // the first measurement is almost exact; half of its correction is applied
        SensorFilter filter({.position = 1,
                             .velocity = 0,
                             .attitude = 0,
                             .angular_velocity = 0,
                             .acceleration_density = 0,
                             .angular_acceleration_density = 0,
                             .gate = 0.99});
        Measured m;
        m.position = Vec3(1e-2, 0, 0);
        m.position_deviation = 1e-5;
        const Analysis a = filter.update({0, {}}, m);
        const Vec3 left = 0.5 * a.shift;
        const double known = 1 / (1 + 1e10); // harmonic sum of 1 and 1e-10
        filter.withhold({.shift = left});
        CHECK(filter.covariance()(0, 0) == about(known + left.x() * left.x()).epsilon(1e-12));
        CHECK(filter.covariance()(1, 1) == about(known).epsilon(1e-9));
        const Analysis next = filter.update({0, {.position = left}}, m);
        CHECK(next.refused == 0);
        const double variance = known + left.x() * left.x();
        CHECK(next.shift.x() == about(left.x() * variance / (variance + 1e-10)).epsilon(1e-9));
    }

    TEST_CASE(
        "a saved filter of another size is refused, and nothing is written behind its memory") {
        SensorFilter filter(FilterSettings{});
        Archive archive;
        const std::vector<double> of_18(18 * 18, 1.0);
        archive.put("filter/root", std::span<const double>(of_18));
        CHECK(message_of<InputError>([&] { filter.load(archive, "filter"); }) ==
              "checkpoint: filter/root: expected 144 numbers, found 324");
    }
}
