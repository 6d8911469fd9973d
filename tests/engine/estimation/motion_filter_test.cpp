#include "engine/estimation/motion_filter.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"
#include "tests/engine/estimation/chi_squared_band.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

const Mat3 one = Mat3::Identity();

Quat about_y(double angle) { return exponential_map(Vec3(0, angle, 0)); }

MotionFilter exact_filter() {
    MotionFilter f;
    f.begin(1e-3, 1e-3, 1e-3, 1e-3);
    return f;
}

/// Adds a random error with the filter's own covariance to its state.
void disturb(MotionFilter& f, Random& random) {
    Vector z(MotionFilter::size);
    for (int k = 0; k < MotionFilter::size; ++k) z[k] = random.normal();
    const Vector e = f.error().root * z;
    f.state.position -= e.segment<3>(0);
    f.state.velocity -= e.segment<3>(3);
    f.state.orientation = exponential_map(-e.segment<3>(6)) * f.state.orientation;
    f.state.angular_velocity -= e.segment<3>(9);
}

/// The filter with the error `e` added to its state.
MotionFilter moved(MotionFilter f, const Vector& e) {
    f.state.position += e.segment<3>(0);
    f.state.velocity += e.segment<3>(3);
    f.state.orientation = exponential_map(e.segment<3>(6)) * f.state.orientation;
    f.state.angular_velocity += e.segment<3>(9);
    return f;
}

Vector difference(const MotionFilter& a, const MotionFilter& b) {
    Vector e(MotionFilter::size);
    e << a.state.position - b.state.position, a.state.velocity - b.state.velocity,
        attitude_error(a.state.orientation, b.state.orientation),
        a.state.angular_velocity - b.state.angular_velocity;
    return e;
}

/// Normalised estimation error squared (NEES) after every kind of observation of a body that
/// tumbles under white-noise acceleration. The filter assumes `noise_factor` times the true noise.
double error_of_tumbling(double noise_factor, std::uint64_t run) {
    constexpr double dt = 0.02, density = 1e-3; // s, (m/s2)2/Hz and (rad/s2)2/Hz
    Random random(77, run);
    const auto noise3 = [&](double s) {
        return Vec3(s * random.normal(), s * random.normal(), s * random.normal());
    };
    RigidState truth{.orientation = random.rotation(), .angular_velocity = Vec3(0.5, -0.3, 0.8)};
    MotionFilter f;
    f.begin(0.01, 0.02, 0.03, 0.02);
    f.state = truth;
    disturb(f, random);
    for (int k = 0; k < 40; ++k) {
        const Vec3 push = noise3(std::sqrt(density / dt)), twist = noise3(std::sqrt(density / dt));
        // the true acceleration is constant within a step: the covariance is T^3/4 instead of
        // T^3/3, which does not matter here
        truth.position += dt * truth.velocity + 0.5 * dt * dt * push;
        truth.velocity += dt * push;
        truth.orientation =
            exponential_map(dt * (truth.angular_velocity + 0.5 * dt * twist)) * truth.orientation;
        truth.angular_velocity += dt * twist;
        f.advance(dt, noise_factor * density, noise_factor * density);
        if (k % 4 == 0) (void)f.observe_position(truth.position + noise3(1e-3), 1e-6 * one);
        if (k % 4 == 1) (void)f.observe_velocity(truth.velocity + noise3(1e-2), 1e-4 * one);
        if (k % 4 == 2)
            (void)f.observe_attitude(exponential_map(noise3(1e-2)) * truth.orientation, 1e-4 * one);
        if (k % 4 == 3)
            (void)f.observe_angular_velocity(truth.angular_velocity + noise3(1e-3), 1e-6 * one);
    }
    Vector e(MotionFilter::size);
    e << truth.position - f.state.position, truth.velocity - f.state.velocity,
        attitude_error(truth.orientation, f.state.orientation),
        truth.angular_velocity - f.state.angular_velocity;
    return squared_distance(f.error(), e);
}

double mean_error_of_tumbling(double noise_factor, std::uint64_t runs) {
    double sum = 0;
    for (std::uint64_t run = 0; run < runs; ++run) sum += error_of_tumbling(noise_factor, run);
    return sum / static_cast<double>(runs);
}

} // namespace

TEST_SUITE("engine/estimation/motion_filter") {
    TEST_CASE("the rotation vector is the inverse of the exponential map up to half a turn") {
        Random random(1, 0);
        for (int k = 0; k < 1000; ++k) {
            const Vec3 v = random.uniform(0, 3.14) * random.direction();
            CHECK((rotation_vector(exponential_map(v)) - v).norm() < 1e-13);
        }
        CHECK(rotation_vector(Quat::Identity()).norm() == 0);
        CHECK((rotation_vector(exponential_map(Vec3(1e-200, 0, 0))) - Vec3(1e-200, 0, 0)).norm() <
              1e-210);
    }

    TEST_CASE("in free motion the attitude is exact") {
        MotionFilter f = exact_filter();
        f.state.angular_velocity = Vec3(0.3, -0.2, 0.5);
        for (int k = 0; k < 10000; ++k) f.advance(1e-3, 0, 0);
        // q(10 s), from the closed form
        const Quat exact(-0.9982371903219421, 0.028883890394124045, -0.019255926929416033,
                         0.04813981732354008);
        CHECK(attitude_error(exact, f.state.orientation).norm() < 1e-11);
    }

    TEST_CASE("pitch passes a right angle and yaw passes half a turn without a jump") {
        MotionFilter f = exact_filter();
        f.state.orientation = about_y(pi / 3);
        f.state.angular_velocity = Vec3(0, pi / 18, 0);
        double worst = 0;
        for (int k = 1; k <= 6000; ++k) { // 60 to 120 degrees at 10 degrees per second
            f.advance(1e-3, 1e-12, 1e-12);
            const Quat truth = about_y(pi / 3 + k * 1e-3 * pi / 18);
            if (k % 10 == 0) (void)f.observe_attitude(truth, 1e-6 * one);
            worst = std::max(worst, attitude_error(truth, f.state.orientation).norm());
        }
        CHECK(worst < 1e-6);

        const auto yaw = [](double degrees) {
            return exponential_map(Vec3(0, 0, degrees * pi / 180));
        };
        f.state.orientation = yaw(179);
        CHECK(f.observe_attitude(yaw(-179), one).innovation.norm() ==
              about(2 * pi / 180).epsilon(1e-9));

        // two turns at 120 degrees per second of a tilted body
        f = exact_filter();
        f.state.orientation = yaw(170) * about_y(0.3);
        f.state.angular_velocity = Vec3(0, 0, 2 * pi / 3);
        worst = 0;
        for (int k = 1; k <= 6000; ++k) {
            f.advance(1e-3, 1e-12, 1e-12);
            const double degrees = 170 + 0.12 * k; // as measured by a compass, from -180 to 180
            const Quat truth = yaw(degrees - 360 * std::round(degrees / 360)) * about_y(0.3);
            if (k % 10 == 0) (void)f.observe_attitude(truth, 1e-6 * one);
            worst = std::max(worst, attitude_error(truth, f.state.orientation).norm());
        }
        CHECK(worst < 1e-6);
    }

    TEST_CASE("free motion changes the covariance as it changes small errors of the state") {
        MotionFilter f;
        f.begin(0.01, 0.02, 0.03, 0.04);
        f.state = {Vec3(1, 2, 3), Vec3(0.3, -0.2, 0.1), exponential_map(Vec3(0.4, -0.7, 0.2)),
                   Vec3(0.5, 1, -2)};
        constexpr double dt = 0.05, small = 1e-5;
        Matrix transition(MotionFilter::size, MotionFilter::size);
        for (int k = 0; k < MotionFilter::size; ++k) {
            const Vector e = small * Vector::Unit(MotionFilter::size, k);
            MotionFilter more = moved(f, e), less = moved(f, -e);
            more.advance(dt, 0, 0);
            less.advance(dt, 0, 0);
            transition.col(k) = difference(more, less) / (2 * small);
        }
        const Matrix expected = transition * f.covariance() * transition.transpose();
        f.advance(dt, 0, 0);
        const Matrix found = f.covariance();
        for (int i = 0; i < MotionFilter::size; ++i)
            for (int k = 0; k < MotionFilter::size; ++k)
                CHECK(std::abs(found(i, k) - expected(i, k)) <
                      1e-6 * std::sqrt(expected(i, i) * expected(k, k)));
    }

    TEST_CASE(
        "without observations the variance of the position grows with the third power of time") {
        // white noise of the acceleration, 100 micro-g per root hertz: 0.57 mm after 1 s, 18 mm
        // after 10 s
        MotionFilter f;
        f.begin(0, 0, 0, 0);
        const double density = 100e-6 * 9.80665;
        for (int k = 1; k <= 2000; ++k) {
            f.advance(5e-3, density * density, 0);
            if (k != 200 && k != 2000) continue;
            const double t = k * 5e-3;
            CHECK(std::sqrt(f.covariance()(0, 0)) ==
                  about(density * std::sqrt(t * t * t / 3)).epsilon(1e-4));
        }
        CHECK(std::sqrt(f.covariance()(0, 0)) == about(0.0179).epsilon(0.01));
        CHECK(f.state.position.norm() == 0);
    }

    TEST_CASE("the error agrees with the filter's covariance after every kind of observation of a "
              "tumbling body, but not if it assumes ten times as much or as little noise") {
        constexpr int runs = 300;
        const testing::Band band = testing::chi_squared_band(0.95, MotionFilter::size, runs);
        const double right = mean_error_of_tumbling(1, runs),
                     much = mean_error_of_tumbling(10, runs),
                     little = mean_error_of_tumbling(0.1, runs);
        CAPTURE(right);
        CAPTURE(much);
        CAPTURE(little);
        CHECK(band.holds(right));
        CHECK(much < band.low);
        CHECK(little > band.high);
    }

    TEST_CASE("an outlier is rejected and changes nothing") {
        MotionFilter f = exact_filter();
        f.gate = chi_squared_quantile(0.99, 3);
        const auto before = f.covariance();
        const ObservationResult verdict = f.observe_position(Vec3(1, 0, 0), 1e-6 * one);
        CHECK_FALSE(verdict.accepted);
        CHECK(verdict.squared_distance > 1e5);
        CHECK(f.state.position.norm() == 0);
        CHECK(f.covariance() == before);
        CHECK_FALSE(f.observe_position(Vec3(std::nan(""), 0, 0), one).accepted);
        CHECK(f.observe_position(Vec3(1e-3, 0, 0), 1e-6 * one).accepted);
    }

    TEST_CASE("a gate accepts observations up to its normalised distance and no farther") {
        const double gate = chi_squared_quantile(0.99, 3);
        // the innovation has the variance of the state and that of the observation
        const auto at = [&](double squared_distance) {
            return Vec3(0, std::sqrt(squared_distance * 2e-6), 0);
        };
        MotionFilter f = exact_filter();
        f.gate = gate;
        CHECK_FALSE(f.observe_position(at(1.01 * gate), 1e-6 * one).accepted);
        const ObservationResult near = f.observe_position(at(0.99 * gate), 1e-6 * one);
        CHECK(near.accepted);
        CHECK(near.squared_distance == about(0.99 * gate).epsilon(1e-9));
    }

    TEST_CASE("a forecast replaces the state, and its uncertainty is added") {
        MotionFilter f = exact_filter();
        Matrix noise = Matrix::Zero(12, 12);
        noise.diagonal().head<3>().setConstant(4e-6);
        const RigidState there{Vec3(1, 2, 3), Vec3::Zero(), about_y(0.4), Vec3::Zero()};
        f.move_to(there, noise);
        CHECK((f.state.position - there.position).norm() == 0);
        CHECK(f.covariance()(0, 0) == about(5e-6));
        CHECK(f.covariance()(6, 6) == about(1e-6));
        (void)f.observe_position(Vec3(1.001, 2, 3), 5e-6 * one);
        CHECK(f.state.position.x() == about(1.0005).epsilon(1e-9));
    }

    TEST_CASE("the covariance stays finite and of full rank over 20 000 updates") {
        MotionFilter f = exact_filter();
        f.state.angular_velocity = Vec3(0.1, 0.2, 0.3);
        double least = 1;
        for (int k = 0; k < 20000; ++k) {
            f.advance(1e-3, 1e-8, 1e-10);
            (void)f.observe_position(Vec3::Zero(), 1e-16 * one);
            (void)f.observe_attitude(f.state.orientation, 1e-20 * one);
            least = std::min(least, f.error().root.diagonal().cwiseAbs().minCoeff());
        }
        // the covariance is positive definite if no diagonal element of its root is 0
        CHECK(least > 0);
        CHECK(f.error().root.allFinite());
    }
}
