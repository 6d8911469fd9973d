#include "systems/fusion/sensor_filter.hpp"
#include "tests/about.hpp"

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
}
