#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/signal/roll_pitch_yaw.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

constexpr double degree = pi / 180;

double largest_step(const std::vector<RollPitchYaw>& series) {
    double largest = 0;
    for (std::size_t k = 1; k < series.size(); ++k)
        largest = std::max({largest, std::abs(series[k].roll - series[k - 1].roll),
                            std::abs(series[k].pitch - series[k - 1].pitch),
                            std::abs(series[k].yaw - series[k - 1].yaw)});
    return largest;
}

} // namespace

TEST_SUITE("engine/signal/roll_pitch_yaw") {
    TEST_CASE("each angle is the right-handed rotation about its axis") {
        // roll about the track x turns the tie y upwards, pitch about the tie turns the track down
        const double a = 0.3;
        CHECK(
            (quaternion_of({a, 0, 0}) * Vec3(0, 1, 0) - Vec3(0, std::cos(a), std::sin(a))).norm() <
            1e-15);
        CHECK(
            (quaternion_of({0, a, 0}) * Vec3(1, 0, 0) - Vec3(std::cos(a), 0, -std::sin(a))).norm() <
            1e-15);
        CHECK(
            (quaternion_of({0, 0, a}) * Vec3(1, 0, 0) - Vec3(std::cos(a), std::sin(a), 0)).norm() <
            1e-15);
    }

    TEST_CASE("angles lead to the attitude and back, at the poles too") {
        Random random(2, 0);
        for (int k = 0; k < 2000; ++k) {
            const Quat q = random.rotation();
            CHECK(attitude_error(quaternion_of(roll_pitch_yaw_of(q)), q).norm() < 1e-12);
        }
        for (const double pitch : {pi / 2, -pi / 2})
            for (const double yaw : {0.0, 1.0, -3.0})
                for (const double roll : {0.0, 0.7, 2.5}) {
                    const Quat q = quaternion_of({roll, pitch, yaw});
                    CHECK(attitude_error(quaternion_of(roll_pitch_yaw_of(q)), q).norm() < 1e-7);
                }
    }

    TEST_CASE(
        "a pitch swept from 60 to 120 degrees passes the pole without a jump of roll or yaw") {
        std::vector<Quat> attitudes;
        for (int k = 0; k <= 6000; ++k)
            attitudes.push_back(quaternion_of({0.1, (60 + 0.01 * k) * degree, -0.2}));
        const auto series = unwrapped_roll_pitch_yaw(attitudes);
        CHECK(largest_step(series) < 0.011 * degree);
        CHECK(series.back().pitch == doctest::Approx(120 * degree).epsilon(1e-7));
        CHECK(series.back().roll == doctest::Approx(0.1).epsilon(1e-6));
        CHECK(series.back().yaw == doctest::Approx(-0.2).epsilon(1e-6));
        for (std::size_t k = 0; k < series.size(); ++k)
            CHECK(attitude_error(quaternion_of(series[k]), attitudes[k]).norm() < 1e-6);
    }

    TEST_CASE("a yaw from 179 to -179 degrees is a step of 2 degrees, and turns are counted") {
        const auto yaws = unwrapped({179 * degree, -179 * degree});
        CHECK(yaws[1] - yaws[0] == doctest::Approx(2 * degree).epsilon(1e-12));
        std::vector<Quat> attitudes;
        for (int k = 0; k <= 1000; ++k) attitudes.push_back(quaternion_of({0, 0.2, 0.02 * k}));
        const auto series = unwrapped_roll_pitch_yaw(attitudes);
        CHECK(series.back().yaw == doctest::Approx(20).epsilon(1e-12));
        CHECK(largest_step(series) < 0.021);
    }
}
