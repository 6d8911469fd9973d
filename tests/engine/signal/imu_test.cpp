#include "engine/errors.hpp"
#include "engine/signal/imu.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

const Vec3 earth(0, 0, -9.80665);

/// Allan deviation: of means over `length` samples, from each mean to the next (Allan 1966).
double allan_deviation(const std::vector<double>& samples, std::size_t length) {
    std::vector<double> means;
    for (std::size_t k = 0; k + length <= samples.size(); k += length) {
        double sum = 0;
        for (std::size_t j = k; j < k + length; ++j) sum += samples[j];
        means.push_back(sum / static_cast<double>(length));
    }
    double sum = 0;
    for (std::size_t k = 1; k < means.size(); ++k)
        sum += (means[k] - means[k - 1]) * (means[k] - means[k - 1]);
    return std::sqrt(0.5 * sum / static_cast<double>(means.size() - 1));
}

} // namespace

TEST_SUITE("engine/signal/imu") {
    TEST_CASE("in any orientation a sensor reads one g upwards at rest and nothing in free fall") {
        Random random(2, 0);
        Imu imu(imu_preset("ideal"), earth, 1, 1);
        for (int k = 0; k < 20; ++k) {
            const Quat q = random.rotation();
            CHECK((imu.sample(0, {.orientation = q}).force - q.conjugate() * Vec3(-earth)).norm() <
                  1e-13);
            CHECK(imu.sample(0, {.orientation = q, .acceleration = earth}).force.norm() < 1e-13);
        }
    }

    TEST_CASE("off the centre of a rotating body a sensor reads the acceleration of its position "
              "and the angular velocity in its own axes") {
        ImuModel model = imu_preset("ideal");
        model.arm = Vec3(0.02, 0, 0);
        model.mounting = exponential_map(Vec3(0, 0, pi / 2)); // its x along the body's y
        Imu imu(model, Vec3::Zero(), 1, 1);
        const ImuSample s = imu.sample(
            0, {.angular_velocity = Vec3(0, 0, 10), .angular_acceleration = Vec3(0, 0, 50)});
        // the body reads -w2 r along x and alpha r along y
        CHECK((s.force - Vec3(50 * 0.02, 100 * 0.02, 0)).norm() < 1e-13);
        CHECK((s.rate - Vec3(0, 0, 10)).norm() < 1e-13);
    }

    TEST_CASE("averaged noise decreases with the square root of the averaging time, with the given "
              "density") {
        ImuModel model;
        model.noise = {.force = 1e-3, .rate = 1e-4};
        Imu imu(model, Vec3::Zero(), 3, 1);
        std::vector<double> force, rate;
        for (int k = 0; k < 400000; ++k) {
            const ImuSample s = imu.sample(k / model.rate, {});
            force.push_back(s.force.x());
            rate.push_back(s.rate.y());
        }
        for (const std::size_t length : {1u, 10u, 100u}) {
            const double time = static_cast<double>(length) / model.rate;
            CHECK(allan_deviation(force, length) == about(1e-3 / std::sqrt(time)).epsilon(0.05));
            CHECK(allan_deviation(rate, length) == about(1e-4 / std::sqrt(time)).epsilon(0.05));
        }
    }

    TEST_CASE("biases differ between devices with the given deviation, and perform a random walk") {
        ImuModel model;
        model.force_bias = 0.02;
        model.noise.rate_bias_walk = 1e-3;
        double squares = 0, walked = 0;
        constexpr int devices = 2000, samples = 100;
        for (std::uint64_t id = 0; id < devices; ++id) {
            Imu imu(model, Vec3::Zero(), 5, id);
            squares += imu.force_bias().squaredNorm() / (3 * devices);
            for (int k = 0; k < samples; ++k) (void)imu.sample(k / model.rate, {});
            walked += imu.rate_bias().squaredNorm() / (3 * devices);
        }
        CHECK(std::sqrt(squares) == about(0.02).epsilon(0.05));
        CHECK(std::sqrt(walked) == about(1e-3 * std::sqrt(samples / model.rate)).epsilon(0.05));
    }

    TEST_CASE("a device at rest without noise reads its biases, which walk from sample to sample") {
        ImuModel model;
        model.force_bias = 0.02;
        model.rate_bias = 0.003;
        model.noise = {.force_bias_walk = 1e-3, .rate_bias_walk = 1e-4};
        double force_squares = 0, rate_squares = 0, walked = 0;
        constexpr int devices = 2000, samples = 20;
        for (std::uint64_t id = 0; id < devices; ++id) {
            Imu imu(model, Vec3::Zero(), 7, id);
            const Vec3 force_at_first = imu.force_bias(), rate_at_first = imu.rate_bias();
            ImuSample s;
            for (int k = 0; k < samples; ++k) {
                s = imu.sample(k / model.rate, {});
                REQUIRE(s.force == imu.force_bias());
                REQUIRE(s.rate == imu.rate_bias());
            }
            force_squares += force_at_first.squaredNorm() / (3 * devices);
            rate_squares += rate_at_first.squaredNorm() / (3 * devices);
            walked += (s.force - force_at_first).squaredNorm() / (3 * devices);
        }
        CHECK(std::sqrt(force_squares) == about(0.02).epsilon(0.05));
        CHECK(std::sqrt(rate_squares) == about(0.003).epsilon(0.05));
        CHECK(std::sqrt(walked) == about(1e-3 * std::sqrt(samples / model.rate)).epsilon(0.05));
    }

    TEST_CASE("the biases of a moving device add to what it would read without them") {
        const TrueMotion motion{.orientation = exponential_map(Vec3(0.3, -0.2, 0.5)),
                                .acceleration = Vec3(1, -2, 0.5),
                                .angular_velocity = Vec3(0.4, 3, -1)};
        ImuModel model;
        const ImuSample exact = Imu(model, earth, 1, 1).sample(0, motion);
        model.force_bias = 0.02;
        model.rate_bias = 0.003;
        Imu imu(model, earth, 1, 1);
        const ImuSample s = imu.sample(0, motion);
        CHECK((s.force - exact.force - imu.force_bias()).norm() < 1e-14);
        CHECK((s.rate - exact.rate - imu.rate_bias()).norm() < 1e-14);
        CHECK(imu.force_bias().norm() > 0);
        CHECK(imu.rate_bias().norm() > 0);
    }

    TEST_CASE("scale factors and axes of devices differ from the true ones by the given "
              "deviations") {
        ImuModel model;
        model.scale_error = 0.01;
        model.misalignment = 0.003;
        double scale = 0, tilt = 0, rate_scale = 0, rate_tilt = 0;
        constexpr int devices = 2000;
        for (std::uint64_t id = 0; id < devices; ++id) {
            Imu imu(model, Vec3::Zero(), 9, id);
            const ImuSample s =
                imu.sample(0, {.acceleration = Vec3(2, 0, 0), .angular_velocity = Vec3(0, 0, 3)});
            scale += std::pow(s.force.x() / 2 - 1, 2) / devices;
            tilt += s.force.tail<2>().squaredNorm() / 4 / (2 * devices);
            rate_scale += std::pow(s.rate.z() / 3 - 1, 2) / devices;
            rate_tilt += s.rate.head<2>().squaredNorm() / 9 / (2 * devices);
        }
        CHECK(std::sqrt(scale) == about(0.01).epsilon(0.05));
        CHECK(std::sqrt(tilt) == about(0.003).epsilon(0.05));
        CHECK(std::sqrt(rate_scale) == about(0.01).epsilon(0.05));
        CHECK(std::sqrt(rate_tilt) == about(0.003).epsilon(0.05));
    }

    TEST_CASE("a sample is rounded to the resolution and limited to the range, and saturation is "
              "flagged") {
        ImuModel model;
        model.force_range = 16;
        model.rate_range = 8;
        model.bits = 8;
        Imu imu(model, Vec3::Zero(), 1, 1);
        const ImuSample s = imu.sample(
            0, {.acceleration = Vec3(0.3, 20, -3), .angular_velocity = Vec3(0.05, 0, 0)});
        CHECK(s.force.x() == 0.25); // steps of 16/128
        CHECK(s.force.y() == 16);
        CHECK(s.saturated);
        CHECK(s.rate.x() == 0.0625);
        CHECK_FALSE(imu.sample(0, {}).saturated);
    }

    TEST_CASE("time stamps show the offset and drift of the clock, and the given fraction of "
              "samples is lost") {
        ImuModel model;
        model.clock_offset = 0.5;
        model.clock_drift = 1e-3;
        model.loss = 0.3;
        Imu imu(model, Vec3::Zero(), 1, 1);
        int lost = 0;
        for (int k = 0; k < 10000; ++k) lost += imu.sample(0, {}).lost ? 1 : 0;
        CHECK(lost == about(3000).epsilon(0.05));
        const ImuSample s = imu.sample(100, {});
        CHECK(s.time == about(100.6).epsilon(1e-12));
        CHECK(s.sequence == 10000);
    }

    TEST_CASE("the low pass removes frequencies above its bandwidth") {
        ImuModel model;
        model.rate = 1000;
        model.bandwidth = 20;
        const auto amplitude = [&](double frequency) {
            Imu imu(model, Vec3::Zero(), 1, 1);
            double largest = 0;
            for (int k = 0; k < 4000; ++k) {
                const double force =
                    imu.sample(
                           0, {.acceleration = Vec3(std::sin(2 * pi * frequency * k / 1000), 0, 0)})
                        .force.x();
                if (k > 2000) largest = std::max(largest, force);
            }
            return largest;
        };
        CHECK(amplitude(1) == about(1).epsilon(0.01));
        CHECK(amplitude(20) == about(std::sqrt(0.5)).epsilon(0.06));
        CHECK(amplitude(200) < 0.15);
    }

    TEST_CASE("an unknown class of sensors is rejected by name") {
        CHECK_THROWS_WITH_AS((void)imu_preset("gold"), doctest::Contains("found 'gold'"),
                             InputError);
        for (const auto name : imu_presets) CHECK_NOTHROW((void)imu_preset(name));
    }
}
