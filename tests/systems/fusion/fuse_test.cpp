#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/collision/collide.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

constexpr double dt = 1e-4;

Collide game() {
    Collide c;
    c.material.density = 2500;
    c.material.young_modulus = 1e8;
    c.material.poisson_ratio = 0.25;
    c.material.restitution = 0.9;
    c.filter.position = 1e-3;
    c.filter.velocity = 0.2;
    return c;
}

/// Few samples, of the velocity only: an error remains, and no position is corrected.
Collide game_with_error_left() {
    Collide c = game();
    c.sampling_rate = 30;
    c.velocity_noise = 0.02;
    c.position_noise = -1;
    // the rebound depends on where in a step the contact begins: with 50 steps by a tenth of the
    // error
    c.steps_per_contact = 400;
    return c;
}

TimedMeasurement at(double time, const Vec3& position) {
    TimedMeasurement m{time, {}};
    m.what.position = position;
    m.what.position_deviation = 1e-9;
    return m;
}

/// For a position that is unknown and a velocity that is known.
FilterSettings certain_motion() {
    return {.position = 1, .velocity = 1e-12, .acceleration_density = 1e-20};
}

/// Two balls at rest in contact, without weight; the first has a sensor.
Simulation pair(std::vector<TimedMeasurement> samples, unsigned injection_steps,
                FilterSettings settings = {}, double distance = 0.0199) {
    World world = make_world(Grains::spheres);
    const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
    world.resource<Materials>().mix();
    (void)add_sphere(world, Vec3(0, 0, 0), 0.01, m);
    (void)add_sphere(world, Vec3(distance, 0, 0), 0.01, m, Motion::fixed);
    add_sensors(world, {0}, {std::move(samples)}, settings, injection_steps);
    return begin(std::move(world), {.dt = 1e-5, .law = LawName::linear, .unlimited = true});
}

Fusion& fusion_of(Simulation& sim) { return sim.world().resource<Fusion>(); }

std::uint64_t counted(Simulation& sim, auto component) {
    return sim.world().column<Sensors, decltype(component)>()[0];
}

} // namespace

TEST_SUITE("fusion/fuse") {
    TEST_CASE("contact transfers the correction of one ball to the other as momentum conservation "
              "requires") {
        for (const double offset : {0.0, 0.7}) {
            Collide c = game_with_error_left();
            c.offset = offset;
            const CollideResult r = run_experiment(c);
            CAPTURE(offset);
            CHECK(r.fused_error < 0.5 * r.free_error);
            CHECK(std::abs(r.error_at_touch) > 1e-3);
            if (offset == 0) CHECK(r.carried_error == about(r.expected_error).epsilon(0.02));
            CHECK(std::abs(r.energy_error) < 1e-3 * std::abs(r.fusion_work));
        }
    }

    TEST_CASE("in an oblique collision of vanishing duration all components of the other ball's "
              "error are those of momentum conservation") {
        const auto collide = [](double offset, double young_modulus) {
            Collide c = game_with_error_left();
            c.offset = offset;
            c.material.young_modulus = young_modulus;
            return run_experiment(c);
        };
        for (const double offset : {0.7, 1.2}) {
            // the line of centres rotates during the contact, whose duration scales as the modulus
            // to the power -2/5
            const CollideResult soft = collide(offset, 1e8), stiff = collide(offset, 1e9);
            const double shorter = std::pow(10, 0.4);
            const Vec3 instantaneous = (shorter * stiff.carried - soft.carried) / (shorter - 1);
            CAPTURE(offset);
            CHECK((soft.carried - soft.expected).norm() < 0.03 * soft.expected.norm());
            for (int axis = 0; axis < 3; ++axis) {
                CAPTURE(axis);
                CHECK(std::abs(stiff.expected[axis]) > 1e-3);
                CHECK(instantaneous[axis] == about(stiff.expected[axis]).epsilon(5e-3));
            }
        }
    }

    TEST_CASE(
        "when one ball hits many, the relative velocity error of each equals that of the first") {
        // Central impact: Hertz contacts with dashpots of a given restitution are similar at all
        // speeds, with overlaps that scale as the speed to the power 4/5. So the velocities of
        // balls in contact are all proportional to it. There is no closed form for how they share
        // the momentum.
        Collide c = game();
        c.balls = 7;
        // the gaps between the balls, which do not scale with the speed, are 1 % of the overlaps
        c.material.young_modulus = 1e7;
        c.sampling_rate = 33;
        c.position_noise = -1;
        // a model as certain of its speed as the sensor follows the sensor only in part
        c.velocity_noise = c.filter.velocity = 1e-9;
        c.filter.acceleration_density = 0;
        c.filter.gate = 1;
        c.steps_per_contact = 400;
        const CollideResult r = run_experiment(c);
        const double share = r.error_at_touch / c.speed;
        CHECK(share == about(0.1 / 7).epsilon(1e-3)); // six samples
        double squares = 0, all = 0;
        for (std::size_t k = 1; k < c.balls; ++k) {
            const Vec3 error = r.fused[k] - r.truth[k], expected = share * r.truth[k];
            squares += (error - expected).squaredNorm();
            all += expected.squaredNorm();
        }
        CHECK(all > 0);
        CHECK(std::sqrt(squares / all) < 0.04);
        for (const std::size_t outer : {4u, 6u})
            CHECK((r.fused[outer] - (1 + share) * r.truth[outer]).norm() <
                  0.01 * share * r.truth[outer].norm());
    }

    TEST_CASE("a precise sensor removes nearly all of the error, of one other ball or of many") {
        for (const unsigned balls : {2u, 7u}) {
            Collide c = game();
            c.balls = balls;
            c.position_noise = 1e-6;
            c.velocity_noise = 1e-5;
            const CollideResult r = run_experiment(c);
            CAPTURE(balls);
            CHECK(r.free_error > 0.01);
            CHECK(r.fused_error < 0.02 * r.free_error);
            CHECK(r.refused < r.accepted / 10);
        }
    }

    TEST_CASE("a sensor cannot correct what happens during a contact: a wrong restitution leaves "
              "its error in the other ball") {
        Collide c = game();
        c.model_speed = 1;
        c.model_restitution = 0.5;
        const CollideResult r = run_experiment(c);
        CHECK(r.fused_error == about(r.free_error).epsilon(0.05));
        CHECK(r.free_error == about(0.5 * (0.9 - 0.5)).epsilon(0.02));
    }

    TEST_CASE(
        "a correction is applied in full, at once or over several steps, and leaves no velocity") {
        for (const unsigned steps : {1u, 50u}) {
            Simulation sim = pair({at(3e-4, Vec3(-1e-3, 2e-4, 0))}, steps, certain_motion(), 0.03);
            sim.advance(30);
            CHECK(value_of<Position>(sim, 0).norm() ==
                  0); // the sample is assimilated at the end of this step
            sim.advance(steps / 2);
            CHECK(std::abs(value_of<Position>(sim, 0).x() - (steps == 1 ? 0 : -0.5e-3)) < 1e-6);
            sim.advance(steps - steps / 2);
            CAPTURE(steps);
            CHECK((value_of<Position>(sim, 0) - Vec3(-1e-3, 2e-4, 0)).norm() < 1e-6);
            CHECK(value_of<Velocity>(sim, 0).norm() < 1e-9);
            CHECK(fusion_work(sim.world()) == 0); // no force opposes it
        }
    }

    TEST_CASE(
        "the energy that a correction stores in a contact is accumulated as work of the fusion") {
        // a ball is moved deeper into a fixed one, whose contact force opposes it
        Simulation sim = pair({at(1e-5, Vec3(5e-5, 0, 0))}, 40, certain_motion());
        const double kn = 1e5, before = 0.5 * kn * 1e-8;
        sim.advance(43); // the correction and one more step, which accumulates its end
        const double overlap = value_of<Position>(sim, 0).x() + 0.0001;
        // velocity at the time of the position, from that in the middle of the step
        const Vec3 now = value_of<Velocity>(sim, 0) -
                         Vec3(0.5e-5 * kn * overlap / value_of<InertialMass>(sim, 0), 0, 0);
        const double energy =
            0.5 * kn * overlap * overlap + 0.5 * value_of<InertialMass>(sim, 0) * now.squaredNorm();
        CHECK(fusion_work(sim.world()) > 0.1 * before);
        CHECK(energy - before == about(fusion_work(sim.world())).epsilon(0.01));
    }

    TEST_CASE(
        "with sensors that record nothing the bodies move as without sensors, to the last bit") {
        const auto positions = [](bool with_sensors) {
            World world = make_world(Grains::spheres);
            const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
            world.resource<Materials>().mix();
            Random random(1, 0);
            for (int k = 0; k < 60; ++k)
                (void)add_sphere(
                    world, Vec3(0.021 * (k % 4), 0.021 * (k / 4 % 4), 0.02 + 0.021 * (k / 16)),
                    0.01 + 1e-4 * random.uniform(), m);
            (void)add_floor(world, m);
            world.add_resource<Gravity>();
            if (with_sensors) add_sensors(world, {3, 17}, {{}, {}}, {}, 10);
            Simulation sim =
                begin(std::move(world), {.dt = 2e-5, .law = LawName::linear, .unlimited = true});
            sim.advance(2000);
            return fingerprint(sim.snapshot(), "bodies/position");
        };
        CHECK(positions(true) == positions(false));
    }

    TEST_CASE("new lists directly after a sample change no bit: contacts see the corrected "
              "velocities with or without them") {
        const auto after = [](bool anew) {
            TimedMeasurement m = at(1e-4, Vec3(-1e-5, 0, 0));
            m.what.velocity = Vec3(0.01, 0.002, 0);
            m.what.velocity_deviation = 1e-4;
            Simulation sim = pair({m}, 5, {.position = 1e-4, .velocity = 1, .gate = 1});
            sim.advance(10);
            CHECK(counted(sim, Accepted{}) == 2);
            if (anew) invalidate_lists(sim.world());
            sim.advance(30);
            return fingerprint(sim.snapshot(), "bodies/");
        };
        CHECK(after(true) == after(false));
    }

    TEST_CASE("a run resumed while a correction is being applied has the same bits") {
        const std::vector<TimedMeasurement> samples{at(3e-4, Vec3(5e-5, 1e-5, 0)),
                                                    at(8e-4, Vec3(4e-5, 2e-5, 0))};
        Simulation whole = pair(samples, 60), resumed = pair(samples, 60);
        whole.advance(50);
        resumed.restore(whole.snapshot());
        whole.advance(100);
        resumed.advance(100);
        CHECK(fingerprint(whole.snapshot()) == fingerprint(resumed.snapshot()));
    }

    TEST_CASE("the schedule of a scene without sensors has no systems of the fusion, and says so") {
        World world = make_world(Grains::spheres);
        (void)add_sphere(world, Vec3::Zero(), 0.01,
                         world.resource<Materials>().add(linear_material(1e5)));
        world.resource<Materials>().mix();
        const Simulation sim =
            begin(std::move(world), {.dt = dt, .law = LawName::linear, .unlimited = true});
        const Simulation fused = pair({at(1, Vec3::Zero())}, 1);
        const auto runs = [](const Simulation& s, const std::string& system) {
            const std::string text = const_cast<Simulation&>(s).schedule().explain();
            const auto line = text.find(system);
            REQUIRE(line != std::string::npos);
            return text.substr(line, text.find('\n', line) - line).find("no sensors") ==
                       std::string::npos &&
                   text.substr(line, text.find('\n', line) - line).find("no bodies.correction") ==
                       std::string::npos;
        };
        CHECK_FALSE(runs(sim, "fuse_spheres"));
        CHECK_FALSE(runs(sim, "apply_correction_displacement"));
        CHECK(runs(fused, "fuse_spheres"));
        CHECK(runs(fused, "apply_correction_displacement"));
    }

    TEST_CASE("an impossible measurement is rejected and counted, and moves nothing") {
        Simulation sim = pair({at(1e-4, Vec3(1, 0, 0)),
                               at(2e-4, Vec3(std::numeric_limits<double>::infinity(), 0, 0))},
                              1, {.position = 1e-4});
        sim.advance(40);
        CHECK(sim.world().column<Sensors, Refused>()[0] ==
              1); // a vector that is not finite counts as not measured
        CHECK(sim.world().column<Sensors, Accepted>()[0] == 0);
        CHECK(sim.world().column<Sensors, LargestInnovation>()[0] > 1e6);
        CHECK(fusion_work(sim.world()) == 0);
    }

    TEST_CASE("each analysis is recorded with its innovation, gain, deviation, share and work, and "
              "the records survive a checkpoint") {
        const double noise = 1e-3, expected = 2e-3;
        std::vector<TimedMeasurement> samples{at(1e-4, Vec3(-1e-3, 0, 0)),
                                              at(2e-4, Vec3(-1e-3, 0, 0))};
        for (TimedMeasurement& m : samples) m.what.position_deviation = noise;
        FilterSettings settings = certain_motion();
        settings.position = expected;
        Simulation sim = pair(samples, 1, settings, 0.03);
        sim.advance(15);
        Simulation resumed = pair(samples, 1, settings, 0.03);
        resumed.restore(sim.snapshot());
        resumed.advance(25);
        const auto& records = fusion_of(resumed).records;
        REQUIRE(records.size() == 2);
        const double both = expected * expected + noise * noise, gain = expected * expected / both,
                     after = noise * std::sqrt(gain);
        CHECK(records[0].time == about(1e-4));
        CHECK(records[0].position_innovation == about(1e-3));
        CHECK(records[0].position_normalised_innovation_squared == about(1e-6 / both));
        CHECK(records[0].position_gain == about(gain));
        CHECK(records[0].position_deviation == about(after));
        CHECK(std::isnan(records[0].attitude_gain)); // not measured
        CHECK(records[0].share == 1);
        CHECK(records[1].position_innovation ==
              about((1 - gain) * 1e-3).epsilon(1e-3)); // the remainder after the first
        CHECK(records[1].position_gain ==
              about(after * after / (after * after + noise * noise)).epsilon(1e-3));
        // a rejected measurement has gain 0
        settings.gate = 0.99;
        samples[1].what.position.x() = 1;
        Simulation refusing = pair(samples, 1, settings, 0.03);
        refusing.advance(40);
        REQUIRE(fusion_of(refusing).records.size() == 2);
        CHECK(fusion_of(refusing).records[1].position_gain == 0);
        CHECK(fusion_of(refusing).records[1].position_deviation == about(after).epsilon(1e-3));
        // the filter exactly as printed in the SmartRock report never has a gain of rotation above
        // 0
        settings.kind = FilterKind::printed;
        for (TimedMeasurement& m : samples)
            m.what.velocity = m.what.angular_velocity = Vec3::Zero();
        Simulation printed = pair(samples, 1, settings, 0.03);
        printed.advance(40);
        REQUIRE(fusion_of(printed).records.size() == 2);
        for (const AnalysisRecord& r : fusion_of(printed).records) CHECK(r.attitude_gain == 0);
    }

    TEST_CASE("a correction beyond the limit of a step is reduced to it, and the covariance "
              "includes the remainder") {
        const Vec3 seen(-1e-3, 2e-4, 1e-4);
        for (const unsigned steps : {1u, 4u}) {
            Simulation sim = pair({at(3e-4, seen)}, steps, certain_motion(), 0.03);
            const double limit = fusion_of(sim).largest_shift = 5e-5;
            sim.advance(30);
            Vec3 before = value_of<Position>(sim, 0);
            for (unsigned k = 0; k < 10; ++k) {
                sim.advance(1);
                const Vec3 now = value_of<Position>(sim, 0);
                CHECK((now - before).norm() < limit * (1 + 1e-9));
                before = now;
            }
            CAPTURE(steps);
            CHECK((before - steps * limit * seen.normalized()).norm() < 1e-9 * limit);
            CHECK(counted(sim, Reduced{}) == 1);
            CHECK(counted(sim, Withheld{}) == 0);
            // the measurement has a deviation of 1e-9 m, so the covariance is that of the remainder
            const Vec3 left = seen - before;
            const Matrix covariance = fusion_of(sim).filters[0].covariance();
            CHECK((covariance.topLeftCorner<3, 3>() - left * left.transpose()).norm() <
                  1e-9 * left.squaredNorm());
        }
    }

    TEST_CASE("a correction a hundred times beyond the limit is withheld: it does not affect the "
              "body, and the covariance includes it") {
        const Vec3 seen(-1e-3, 2e-4, 0);
        Simulation sim = pair({at(3e-4, seen)}, 1, certain_motion()),
                   alone = pair({}, 1, certain_motion());
        fusion_of(sim).largest_shift = 9e-6;
        sim.advance(60);
        alone.advance(30);
        const Vec3 left = seen - value_of<Position>(alone, 0); // at the time of the sample
        alone.advance(30);
        CHECK(counted(sim, Withheld{}) == 1);
        CHECK(counted(sim, Reduced{}) == 0);
        CHECK(counted(sim, Accepted{}) == 1);
        CHECK(fingerprint(sim.snapshot(), "bodies/") == fingerprint(alone.snapshot(), "bodies/"));
        CHECK(
            (fusion_of(sim).filters[0].covariance().topLeftCorner<3, 3>() - left * left.transpose())
                .norm() < 1e-6 * left.squaredNorm());
    }

    TEST_CASE("a spinning ball is nudged by the measured rotation, which spins with the ball") {
        const Vec3 turn(0.1, 0, 0), angular_velocity(0, 0, 200);
        TimedMeasurement m{3e-4, {}};
        m.what.attitude = exponential_map(turn);
        m.what.attitude_deviation = 1e-9;
        Simulation sim = pair({m}, 1,
                              {.attitude = 1,
                               .angular_velocity = 1e-12,
                               .angular_acceleration_density = 1e-20,
                               .gate = 1},
                              0.06);
        set_angular_velocity(sim.world(), 0, angular_velocity);
        fusion_of(sim).nudging = {1e-12, 0, 0.01}; // without force
        sim.advance(30);
        REQUIRE(value_of<Nudging>(sim, 0).is_active());
        for (int n = 0; n < 1000; ++n) {
            sim.advance();
            const Vec3 expected = exponential_map(n * 1e-5 * angular_velocity) * turn;
            CHECK((rotation_vector(value_of<Nudging>(sim, 0).attitude) - expected).norm() < 1e-9);
        }
    }

    TEST_CASE("the remainder of a reduced correction is applied with the next samples") {
        std::vector<TimedMeasurement> samples;
        for (const double time : {1e-4, 2e-4, 3e-4, 4e-4, 5e-4})
            samples.push_back(at(time, Vec3(-1e-3, 0, 0)));
        Simulation sim = pair(std::move(samples), 1, certain_motion(), 0.03);
        fusion_of(sim).largest_shift = 3e-4;
        sim.advance(60);
        CHECK(counted(sim, Reduced{}) == 3);
        CHECK(counted(sim, Refused{}) == 0);
        CHECK((value_of<Position>(sim, 0) - Vec3(-1e-3, 0, 0)).norm() < 1e-9);
    }

    TEST_CASE("observations that place two touching spheres a radius inside each other stop a run "
              "without a limit of corrections, but not one with a limit") {
        std::vector<TimedMeasurement> samples;
        for (const double time : {1e-4, 2e-4, 3e-4}) samples.push_back(at(time, Vec3(0.01, 0, 0)));
        Simulation inserted = pair(samples, 1, certain_motion(), 0.02);
        inserted.world().resource<Limits>().overlap = 0.25;
        CHECK_THROWS_AS(inserted.advance(100), SimulationError);
        Simulation limited = pair(samples, 1, certain_motion(), 0.02);
        limited.world().resource<Limits>().overlap = 0.25;
        fusion_of(limited).largest_shift = 2e-4;
        double deepest = 0;
        for (unsigned k = 0; k < 3000; ++k) {
            limited.advance(1);
            deepest = std::max(deepest, value_of<Position>(limited, 0).x());
        }
        CHECK(counted(limited, Reduced{}) == 3);
        CHECK(deepest > 2e-4);
        CHECK(deepest < 6.1e-4);
        // the contact pushes it out again, with no more energy than the corrections put in
        CHECK(value_of<Position>(limited, 0).x() < 0);
        CHECK(0.5 * value_of<InertialMass>(limited, 0) *
                  value_of<Velocity>(limited, 0).squaredNorm() <
              1.01 * fusion_work(limited.world()));
    }

    TEST_CASE("a limit that is not reached changes no bit") {
        const std::vector<TimedMeasurement> samples{at(3e-4, Vec3(5e-5, 1e-5, 0)),
                                                    at(8e-4, Vec3(4e-5, 2e-5, 0))};
        Simulation plain = pair(samples, 60), other = pair(samples, 60);
        fusion_of(other).largest_shift = 1;
        plain.advance(200);
        other.advance(200);
        CHECK(fingerprint(plain.snapshot(), "bodies/") == fingerprint(other.snapshot(), "bodies/"));
        CHECK(fingerprint(plain.snapshot(), "sensors/") ==
              fingerprint(other.snapshot(), "sensors/"));
    }

    TEST_CASE("each sensor needs a host of its own and samples in the order of time") {
        World world = make_world(Grains::spheres);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1, 1}, {{}, {}}, {}),
                             doctest::Contains("one for each host"), InputError);
        CHECK_THROWS_WITH_AS(
            add_sensors(world, {1}, {{at(2, Vec3::Zero()), at(1, Vec3::Zero())}}, {}),
            doctest::Contains("order of time"), InputError);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1}, {}, {}), doctest::Contains("found 0"),
                             InputError);
    }
}
