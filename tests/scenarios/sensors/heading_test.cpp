#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/sensors/heading.hpp"
#include "scenarios/sensors/quality_control.hpp"
#include "scenarios/sensors/sensor_trajectory.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

constexpr double degree = pi / 180;
const Vec3 earths(0, 20e-6, -44e-6); // T, east north up: 48.3 uT, dip 65.6 degrees

/// A rock at rest for ten samples, which then rotates steadily by a rotation vector (world frame)
/// during ninety samples and 1 % of strain.
Recording turning(const Vec3& turn, std::uint64_t seed, double noise = 0.5e-6,
                  const Vec3& bias = Vec3::Zero()) {
    Recording r;
    Random random(seed, 1);
    const Quat start = random.rotation();
    const auto scatter = [&](double deviation) -> Vec3 {
        return deviation * Vec3(random.normal(), random.normal(), random.normal());
    };
    r.info.id = 5;
    r.info.sampling_rate = 0.1;
    r.info.set_pose(Vec3::Zero(), start);
    for (int k = 0; k < 100; ++k) {
        const double share = std::max(0, k - 9) / 90.0;
        const Quat now = exponential_map(Vec3(share * turn)) * start;
        r.time.push_back(10.0 * k);
        r.strain.push_back(0.01 * share);
        r.force.push_back(now.conjugate() * Vec3(0, 0, 9.81) + scatter(3e-4));
        r.rate.push_back(now.conjugate() * (turn / 900) + scatter(1e-5));
        r.field.push_back(now.conjugate() * earths + bias + scatter(noise));
    }
    return r;
}

std::string found(const Recording& r, const std::string& check) {
    std::string text;
    for (const Finding& f : check_recordings({r}, Vec3(0, 0, -9.81)))
        if (f.check == check) text += f.text + "\n";
    return text;
}

} // namespace

TEST_SUITE("sensors/heading") {
    TEST_CASE("in a steady field a magnetometer measures the rotation of a rock about the "
              "vertical, whatever its tilt") {
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            const Heading h = heading_of(turning(Vec3(0.15, -0.1, 0.3), seed, 1e-9));
            REQUIRE(h.observable());
            CHECK(std::abs(h.turn - 0.3) <
                  0.001); // noise of the force, 3e-5 times the tangent of the dip, and of the field
            CHECK(h.dip == about(65.6 * degree).epsilon(1e-2));
        }
    }

    TEST_CASE("with noise and biases as declared, the errors of the yaw are consistent with its "
              "stated standard deviation") {
        int within_one = 0, within_two = 0;
        double squares = 0;
        for (std::uint64_t seed = 1; seed <= 400; ++seed) {
            Random random(seed, 9);
            const Vec3 bias = 2e-6 * Vec3(random.normal(), random.normal(), random.normal());
            const Heading h = heading_of(turning(Vec3(0.05, 0.1, 0.5), seed, 0.5e-6, bias));
            REQUIRE(h.observable());
            const double error = std::abs(h.turn - 0.5) / h.deviation;
            within_one += error < 1;
            within_two += error < 2;
            squares += error * error / 400;
        }
        // the scatter of the field counts as if it were all horizontal: conservative by at most a
        // factor of two
        CHECK(within_one > 270);
        CHECK(within_two > 380);
        CHECK(squares > 0.25);
        CHECK(squares < 1.2);
    }

    TEST_CASE("yaw is not observable from a field that is disturbed, stuck, in another unit or "
              "nearly vertical, and quality control states the reason") {
        const Recording good = turning(Vec3(0, 0, 0.2), 3);
        INFO(found(good, "field"));
        CHECK(found(turning(Vec3(0, 0, 0.2), 3, 1e-9), "field")
                  .find("yaw is observable, at the end +11.") != std::string::npos);
        CHECK(found(good, "field").find("it is not assimilated") != std::string::npos);
        Recording r = good;
        for (std::size_t k = 40; k < 100; ++k)
            r.field[k] += Vec3(0, 6e-6, 8e-6); // a train of steel
        CHECK(found(r, "field").find("yaw is not observable: the field is disturbed") !=
              std::string::npos);
        r = good;
        for (Vec3& b : r.field) b *= 1e-3;
        CHECK(found(r, "field").find("expected the field of the earth, 20 to 70 uT, found 0.04") !=
              std::string::npos);
        r = good;
        std::fill(r.field.begin() + 50, r.field.end(), r.field[50]);
        CHECK(found(r, "field").find("found a constant field") != std::string::npos);
        r = good;
        for (std::size_t k = 0; k < 100; ++k)
            r.field[k] =
                -48e-6 * r.force[k].normalized() + 1e-7 * Vec3(std::sin(k), std::cos(k), 0);
        CHECK(found(r, "field").find("expected a horizontal component") != std::string::npos);
        r = good;
        r.force.clear();
        CHECK(found(r, "field").find("expected at least 10 samples with field and force") !=
              std::string::npos);
        // axes of the other handedness than those of the force show when the rock tilts
        r = turning(Vec3(0.4, 0.3, 0), 3);
        for (Vec3& b : r.field) b.x() = -b.x();
        CHECK(found(r, "field").find("disturbed, or its axes differ") != std::string::npos);
        // samples without a field are ignored and counted
        r = good;
        for (std::size_t k = 0; k < 100; k += 2) r.field[k] = Vec3::Constant(std::nan(""));
        CHECK(heading_of(r).observable());
        CHECK(found(r, "numbers").find("50 of 100 samples have no number") != std::string::npos);
    }

    TEST_CASE("yaw from attitudes is reported beside yaw from the field, with a warning if the two "
              "differ") {
        Recording r = turning(Vec3(0, 0, 0.2), 3);
        const Quat start = r.info.attitude();
        for (const double e : r.strain)
            r.attitude.push_back(exponential_map(Vec3(0, 0, 20 * e)) * start);
        CHECK(found(r, "field").find("by the attitudes +11.5\n") != std::string::npos);
        for (std::size_t k = 0; k < 100; ++k)
            r.attitude[k] = exponential_map(Vec3(0, 0, -20 * r.strain[k])) * start;
        CHECK(found(r, "field")
                  .find("by the attitudes -11.5: the axes of one of the two are wrong") !=
              std::string::npos);
    }

    TEST_CASE("yaw is observable by a magnetometer in a steady field, and not in a disturbed one") {
        Recording r = turning(Vec3(0, 0, 0.2), 3);
        const auto yaw = [](const Recording& one) {
            return observability_of(one, 960, 1e-3, 0.1)[4];
        };
        CHECK(yaw(r).source == "magnetometer (unused)");
        CHECK(yaw(r).observable());
        CHECK(yaw(r).deviation == heading_of(r).deviation);
        for (std::size_t k = 40; k < 100; ++k) r.field[k] *= 1.3;
        CHECK(yaw(r).source == "integrated rate");
        CHECK_FALSE(yaw(r).observable());
        r.field.clear();
        CHECK(yaw(r).source == "integrated rate");
    }
}
