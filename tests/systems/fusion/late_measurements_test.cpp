#include "engine/random.hpp"
#include "systems/fusion/sensor_filter.hpp"
#include "tests/about.hpp"

#include <Eigen/LU>
#include <doctest/doctest.h>

#include <vector>

using namespace bris;

namespace {

/// A body that a simulation moves freely and to which corrections are applied.
struct Model {
    RigidState state{.position = Vec3(0.1, 0, 0),
                     .velocity = Vec3(0.3, -0.1, 0.2),
                     .orientation = exponential_map(Vec3(0.3, 0.2, -0.5)),
                     .angular_velocity = Vec3(0.5, -2, 1)};
    double time = 0;

    BodyForecast go_to(double t) {
        state.position += (t - time) * state.velocity;
        state.orientation =
            (exponential_map((t - time) * state.angular_velocity) * state.orientation).normalized();
        time = t;
        return {t, state};
    }
    void give(const Analysis& a) {
        state.position += a.shift;
        state.velocity += a.velocity;
        state.orientation = (exponential_map(a.turn) * state.orientation).normalized();
        state.angular_velocity += a.angular_velocity;
    }
};

FilterSettings settings_with(unsigned lag) {
    return {.position = 0.02,
            .velocity = 0.1,
            .attitude = 0.1,
            .angular_velocity = 0.3,
            .acceleration_density = 1e-2,
            .angular_acceleration_density = 0.1,
            .drift = 1e-5,
            .turning = 1e-4,
            .gate = 1,
            .lag = lag};
}

/// Measurement k of a sensor: position and attitude, and every second time angular velocity.
Measured measured_at(unsigned k) {
    Random random(4, k);
    const auto noise = [&](double deviation) -> Vec3 {
        return deviation * Vec3(random.normal(), random.normal(), random.normal());
    };
    Measured m;
    const double t = 0.05 * k;
    m.position = Vec3(0.11, 0.01, 0) + t * Vec3(0.35, -0.1, 0.15) + noise(1e-3);
    m.position_deviation = 1e-3;
    m.attitude = exponential_map(noise(0.01)) * exponential_map(t * Vec3(0.4, -1.8, 1)) *
                 exponential_map(Vec3(0.3, 0.25, -0.5));
    m.attitude_deviation = 0.01;
    if (k % 2 == 0) m.angular_velocity = Vec3(0.4, -1.8, 1) + noise(0.1);
    m.angular_velocity_deviation = 0.1;
    return m;
}

struct End {
    RigidState state;
    Matrix covariance;
    unsigned too_late = 0;
};

constexpr unsigned last = 12;

/// Steps of 0.05 s with a measurement each; those in `late_ones` arrive `delay` steps later.
/// `notes`: the motion is stored at the times of late measurements.
End fused(const std::vector<unsigned>& late_ones, unsigned delay, unsigned lag, bool notes) {
    Model model;
    SensorFilter filter(settings_with(lag));
    End end;
    for (unsigned k = 1; k <= last; ++k) {
        const BodyForecast now = model.go_to(0.05 * k);
        if (std::ranges::count(late_ones, k) == 0)
            model.give(filter.update(now, measured_at(k)));
        else if (notes)
            filter.note(now);
        for (const unsigned late : late_ones) {
            if (late + delay != k) continue;
            filter.note(now);
            const auto a = filter.update_late(0.05 * late, measured_at(late));
            if (a)
                model.give(*a);
            else
                ++end.too_late;
        }
    }
    end.state = model.state;
    end.covariance = filter.covariance();
    return end;
}

double difference(const End& a, const End& b) {
    return (a.state.position - b.state.position).norm() +
           (a.state.velocity - b.state.velocity).norm() +
           (a.state.angular_velocity - b.state.angular_velocity).norm() +
           attitude_error(a.state.orientation, b.state.orientation).norm() +
           (a.covariance - b.covariance).norm();
}

/// A body at rest that the model does not move; the truth walks at random.
struct RandomWalk {
    static constexpr unsigned steps = 9;
    static constexpr double drift = 1e-6, deviation = 2e-3, start = 5e-3;
    std::vector<Vec3> truth, seen;

    explicit RandomWalk(std::uint64_t seed) {
        Random random(seed, 0);
        const auto noise = [&](double size) -> Vec3 {
            return size * Vec3(random.normal(), random.normal(), random.normal());
        };
        for (unsigned k = 0; k < steps; ++k) {
            truth.push_back(k == 0 ? noise(start) : Vec3(truth.back() + noise(std::sqrt(drift))));
            seen.push_back(truth.back() + noise(deviation));
        }
    }
    SensorFilter filtered(double assumed_drift = drift) const {
        SensorFilter filter({.position = start,
                             .velocity = 0,
                             .attitude = 0,
                             .angular_velocity = 0,
                             .acceleration_density = 0,
                             .angular_acceleration_density = 0,
                             .drift = assumed_drift,
                             .gate = 1,
                             .lag = steps});
        RigidState model;
        for (unsigned k = 0; k < steps; ++k) {
            Measured m;
            m.position = seen[k];
            m.position_deviation = deviation;
            model.position += filter.update({1.0 * k, model}, m).shift;
        }
        return filter;
    }
};

} // namespace

TEST_SUITE("fusion/late_measurements") {
    TEST_CASE("late measurements within the lag give the same estimate and covariance as on time") {
        const End on_time = fused({}, 0, 0, false);
        REQUIRE(on_time.covariance(0, 0) > 1e-8);
        CHECK(difference(fused({}, 0, 8, false), on_time) == 0); // stored analyses change nothing
        CHECK(difference(fused({6}, 0, 0, false), on_time) > 1e-6); // a missing measurement does
        for (const bool notes : {true, false})
            for (const auto& late : std::vector<std::vector<unsigned>>{
                     {6}, {5, 6}, {4, 5, 7, 8}, {2, 3, 4, 5, 6, 7, 8}}) {
                const End end = fused(late, 4, 8, notes);
                CAPTURE(late.size());
                CAPTURE(notes);
                CHECK(end.too_late == 0);
                // free motion is uniform, so the interpolation between two analyses is exact; the
                // tolerance is for sums of numbers up to 2 in another order
                CHECK(difference(end, on_time) < 1e-12);
            }
    }

    TEST_CASE("a measurement later than the lag is refused and changes nothing") {
        const End without = fused({6}, 100, 3, true);
        CHECK(difference(fused({6}, 4, 3, true), without) == 0);
        CHECK(fused({6}, 4, 3, true).too_late == 1);
        CHECK(fused({6}, 4, 4, true).too_late == 0);
        CHECK(fused({6}, 4, 0, true).too_late == 1);  // no lag: all are too late
        CHECK(fused({1}, 2, 8, false).too_late == 1); // time before the first analysis
        FilterSettings printed = settings_with(8);
        printed.kind = FilterKind::printed;
        SensorFilter filter(printed);
        (void)filter.update({1, {}}, measured_at(1));
        CHECK_FALSE(filter.update_late(0.5, measured_at(1)).has_value());
    }

    TEST_CASE("the gate rejects an inconsistent late measurement, and the body stays") {
        FilterSettings settings = settings_with(8);
        settings.gate = 0.999;
        SensorFilter filter(settings);
        Model model;
        for (unsigned k = 1; k <= 5; ++k) {
            const BodyForecast now = model.go_to(0.05 * k);
            if (k == 3)
                filter.note(now);
            else
                model.give(filter.update(now, measured_at(k)));
        }
        const Matrix before = filter.covariance();
        Measured wrong;
        wrong.position = Vec3(1, 1, 1);
        wrong.position_deviation = 1e-3;
        const auto a = filter.update_late(0.15, wrong);
        REQUIRE(a.has_value());
        CHECK(a->refused == 1);
        CHECK(a->largest_distance > 1e3);
        CHECK(a->shift.norm() + a->velocity.norm() + a->turn.norm() + a->angular_velocity.norm() <
              1e-14);
        CHECK((filter.covariance() - before).norm() < 1e-14);
    }

    TEST_CASE("a filter loaded from an archive continues with the same bits, for late measurements "
              "as well") {
        Model model;
        SensorFilter filter(settings_with(5));
        for (unsigned k = 1; k <= 6; ++k) {
            if (k == 4)
                filter.note(model.go_to(0.2));
            else
                model.give(filter.update(model.go_to(0.05 * k), measured_at(k)));
        }
        Archive archive;
        filter.save(archive, "filter");
        SensorFilter loaded(settings_with(5));
        loaded.load(archive, "filter");
        const auto same = [](const Analysis& a, const Analysis& b) {
            return a.shift == b.shift && a.velocity == b.velocity && a.turn == b.turn &&
                   a.angular_velocity == b.angular_velocity;
        };
        const auto a = filter.update_late(0.2, measured_at(4)),
                   b = loaded.update_late(0.2, measured_at(4));
        REQUIRE((a && b));
        CHECK(same(*a, *b));
        CHECK(a->shift.norm() > 1e-6);
        model.give(*a);
        const BodyForecast now = model.go_to(0.35);
        CHECK(same(filter.update(now, measured_at(7)), loaded.update(now, measured_at(7))));
        CHECK(filter.covariance() == loaded.covariance());
        CHECK(filter.smoothed().front().position == loaded.smoothed().front().position);
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

    TEST_CASE("a filter that stores its analyses continues from its own estimate: the withheld "
              "part is corrected next time, and the covariance does not grow") {
        Model model;
        SensorFilter filter(settings_with(3)), followed(settings_with(3));
        Model other = model;
        model.give(filter.update(model.go_to(0.05), measured_at(1)));
        const Analysis a = followed.update(other.go_to(0.05), measured_at(1));
        followed.withhold(a); // nothing is applied
        const Analysis next = filter.update(model.go_to(0.1), measured_at(2)),
                       all = followed.update(other.go_to(0.1), measured_at(2));
        model.give(next);
        other.give(all);
        CHECK((a.shift.norm() > 1e-3 && all.shift.norm() > next.shift.norm()));
        CHECK((model.state.position - other.state.position).norm() < 1e-14);
        CHECK((model.state.velocity - other.state.velocity).norm() < 1e-14);
        CHECK(attitude_error(model.state.orientation, other.state.orientation).norm() < 1e-14);
        CHECK((filter.covariance() - followed.covariance()).norm() < 1e-14);
    }

    TEST_CASE("smoothed poses and deviations are those of one estimate from all measurements") {
        const RandomWalk walk(3);
        const auto smoothed = walk.filtered().smoothed();
        constexpr Eigen::Index n = RandomWalk::steps;
        REQUIRE(smoothed.size() == RandomWalk::steps);
        // information of the initial state, of the steps and of the measurements
        Matrix information = Matrix::Zero(n, n), sum = Matrix::Zero(n, 3);
        information(0, 0) += 1 / (RandomWalk::start * RandomWalk::start);
        for (Eigen::Index k = 0; k < n; ++k) {
            information(k, k) += 1 / (RandomWalk::deviation * RandomWalk::deviation);
            sum.row(k) = walk.seen[static_cast<std::size_t>(k)].transpose() /
                         (RandomWalk::deviation * RandomWalk::deviation);
            if (k == 0) continue;
            information(k, k) += 1 / RandomWalk::drift;
            information(k - 1, k - 1) += 1 / RandomWalk::drift;
            information(k, k - 1) -= 1 / RandomWalk::drift;
            information(k - 1, k) -= 1 / RandomWalk::drift;
        }
        const Matrix covariance = information.inverse(), mean = covariance * sum;
        for (Eigen::Index k = 0; k < n; ++k) {
            const SmoothedPose& pose = smoothed[static_cast<std::size_t>(k)];
            CAPTURE(k);
            CHECK((pose.position - Vec3(mean.row(k).transpose())).norm() < 1e-12);
            CHECK(pose.position_deviation.x() == about(std::sqrt(covariance(k, k))).epsilon(1e-9));
            CHECK(pose.time == k);
        }
    }

    TEST_CASE("smoothed poses have the errors that their deviations predict, unless a wrong drift "
              "is assumed, and smaller errors than without later measurements") {
        constexpr unsigned runs = 150;
        double honest = 0, light = 0, heavy = 0, error = 0, error_before = 0;
        for (unsigned run = 0; run < runs; ++run) {
            const RandomWalk walk(100 + run);
            const auto distance = [&](double drift) {
                const SmoothedPose pose = walk.filtered(drift).smoothed()[4];
                return (pose.position - walk.truth[4])
                           .cwiseQuotient(pose.position_deviation)
                           .squaredNorm() /
                       (3.0 * runs);
            };
            honest += distance(RandomWalk::drift);
            light += distance(RandomWalk::drift / 20);
            heavy += distance(RandomWalk::drift * 20);
            error += (walk.filtered().smoothed()[0].position - walk.truth[0]).squaredNorm();
            error_before += (walk.seen[0] - walk.truth[0]).squaredNorm();
        }
        // mean of 450 chi-squared numbers with one degree of freedom: 1 +- 0.13 with 95 %
        CHECK(std::abs(honest - 1) < 0.15);
        CHECK(light > 1.3);
        CHECK(heavy < 0.85);
        CHECK(error < 0.6 * error_before);
    }
}
