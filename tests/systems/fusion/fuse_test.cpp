#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/specimens/bench.hpp"
#include "scenarios/verification/collide.hpp"
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

/// Few samples of the velocity alone: an error is left, and nothing jumps.
Collide game_with_error_left() {
    Collide c = game();
    c.sampling_rate = 30;
    c.velocity_noise = 0.02;
    c.position_noise = -1;
    c.steps_per_contact =
        400; // where in a step contact begins shows in the rebound: by a tenth of that error at 50
    return c;
}

TimedMeasurement at(double time, const Vec3& position) {
    TimedMeasurement m{time, {}};
    m.what.position = position;
    m.what.position_deviation = 1e-9;
    return m;
}

/// Of a place that is not known at all, and a velocity that is.
FilterSettings certain_motion() {
    return {.position = 1, .velocity = 1e-12, .acceleration_density = 1e-20};
}

/// Two balls that rest against each other, without weight; the first has a sensor.
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

/// A ball that flies otherwise than the model believes, seen every millisecond; samples of the
/// named times (ms) come late.
Simulation flight(const std::vector<unsigned>& late, double lateness, unsigned lag,
                  double note_every) {
    std::vector<TimedMeasurement> samples;
    for (unsigned k = 1; k <= 10; ++k) {
        TimedMeasurement m =
            at(1e-3 * k, Vec3(1e-3, 0, 0) + 1e-3 * k * Vec3(-0.05, 0.1, 0.02 * (k % 3)));
        m.what.position_deviation = 1e-4;
        if (std::ranges::count(late, k) > 0) m.arrives += lateness;
        samples.push_back(m);
    }
    std::ranges::stable_sort(samples, {}, &TimedMeasurement::arrives);
    Simulation sim = pair(
        std::move(samples), 1,
        {.position = 2e-3, .velocity = 0.1, .acceleration_density = 1e-3, .gate = 1, .lag = lag},
        0.06);
    fusion_of(sim).note_every = note_every;
    return sim;
}

std::uint64_t counted(Simulation& sim, auto component) {
    return sim.world().column<Sensors, decltype(component)>()[0];
}

} // namespace

TEST_SUITE("systems/fusion/fuse") {
    TEST_CASE("what the sensor of one ball tells, contact carries to the other, as momentum "
              "conservation says") {
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

    TEST_CASE("off centre, all components of the other ball's error are as momentum conservation "
              "says, where balls touch for no time") {
        const auto collide = [](double offset, double young_modulus) {
            Collide c = game_with_error_left();
            c.offset = offset;
            c.material.young_modulus = young_modulus;
            return run_experiment(c);
        };
        for (const double offset : {0.7, 1.2}) {
            // the line of centres turns while they touch, a time that goes as the modulus to the
            // -2/5
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

    TEST_CASE("of many balls hit at once, each one's error is in proportion to its own velocity, "
              "as the first ball's is") {
        // Centre to centre: contacts of Hertz with dashpots of a given restitution are the same at
        // any speed, with overlaps that go as its power 4/5. So balls that touch all start off in
        // proportion to it. How momentum is shared among them no closed form says.
        Collide c = game();
        c.balls = 7;
        c.material.young_modulus =
            1e7; // the gaps between them, which do not go along, are 1 % of the overlaps
        c.sampling_rate = 33;
        c.position_noise = -1;
        c.velocity_noise = c.filter.velocity = 1e-9; // a model as sure of its speed as the sensor
                                                     // of its own goes there a part of the way
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

    TEST_CASE("with a good sensor hardly any error is left, of one ball or of many") {
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

    TEST_CASE("what happens within a touch a sensor cannot mend: another restitution leaves its "
              "error in the other ball") {
        Collide c = game();
        c.model_speed = 1;
        c.model_restitution = 0.5;
        const CollideResult r = run_experiment(c);
        CHECK(r.fused_error == about(r.free_error).epsilon(0.05));
        CHECK(r.free_error == about(0.5 * (0.9 - 0.5)).epsilon(0.02));
    }

    TEST_CASE("a correction arrives whole, at once or in steps, and leaves no velocity behind") {
        for (const unsigned steps : {1u, 50u}) {
            Simulation sim = pair({at(3e-4, Vec3(-1e-3, 2e-4, 0))}, steps, certain_motion(), 0.03);
            sim.advance(30);
            CHECK(value_of<Position>(sim, 0).norm() ==
                  0); // the sample is taken at the end of this step
            sim.advance(steps / 2);
            CHECK(std::abs(value_of<Position>(sim, 0).x() - (steps == 1 ? 0 : -0.5e-3)) < 1e-6);
            sim.advance(steps - steps / 2);
            CAPTURE(steps);
            CHECK((value_of<Position>(sim, 0) - Vec3(-1e-3, 2e-4, 0)).norm() < 1e-6);
            CHECK(value_of<Velocity>(sim, 0).norm() < 1e-9);
            CHECK(fusion_work(sim.world()) == 0); // against nothing
        }
    }

    TEST_CASE("what a correction stores in a contact is booked as work of fusion") {
        // a ball is pushed deeper into a fixed one, which pushes back meanwhile
        Simulation sim = pair({at(1e-5, Vec3(5e-5, 0, 0))}, 40, certain_motion());
        const double kn = 1e5, before = 0.5 * kn * 1e-8;
        sim.advance(43); // the correction and one step more, which books its end
        const double overlap = value_of<Position>(sim, 0).x() + 0.0001;
        // velocity of the time of the position, from the middle of the step
        const Vec3 now = value_of<Velocity>(sim, 0) -
                         Vec3(0.5e-5 * kn * overlap / value_of<InertialMass>(sim, 0), 0, 0);
        const double energy =
            0.5 * kn * overlap * overlap + 0.5 * value_of<InertialMass>(sim, 0) * now.squaredNorm();
        CHECK(fusion_work(sim.world()) > 0.1 * before);
        CHECK(energy - before == about(fusion_work(sim.world())).epsilon(0.01));
    }

    TEST_CASE("with all sensors dead the bodies move as without any, to the last bit") {
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

    TEST_CASE("new lists right after a sample change no bit: contacts see what it did to "
              "velocities all the same") {
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

    TEST_CASE("a run resumed between a sample and the end of its correction has the same bits") {
        const std::vector<TimedMeasurement> samples{at(3e-4, Vec3(5e-5, 1e-5, 0)),
                                                    at(8e-4, Vec3(4e-5, 2e-5, 0))};
        Simulation whole = pair(samples, 60), resumed = pair(samples, 60);
        whole.advance(50);
        resumed.restore(whole.snapshot());
        whole.advance(100);
        resumed.advance(100);
        CHECK(fingerprint(whole.snapshot()) == fingerprint(resumed.snapshot()));
    }

    TEST_CASE("a scene without sensors has none of fusion in its schedule, and says so") {
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

    TEST_CASE("a sensor that says what cannot be is refused, counted, and moves nothing") {
        Simulation sim = pair({at(1e-4, Vec3(1, 0, 0)),
                               at(2e-4, Vec3(std::numeric_limits<double>::infinity(), 0, 0))},
                              1, {.position = 1e-4});
        sim.advance(40);
        CHECK(sim.world().column<Sensors, Refused>()[0] ==
              1); // what is not a number was not measured
        CHECK(sim.world().column<Sensors, Accepted>()[0] == 0);
        CHECK(sim.world().column<Sensors, LargestInnovation>()[0] > 1e6);
        CHECK(fusion_work(sim.world()) == 0);
    }

    TEST_CASE("each analysis is kept with its innovation, gain, deviation, share and work, through "
              "a checkpoint too") {
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
              about((1 - gain) * 1e-3).epsilon(1e-3)); // what the first has left
        CHECK(records[1].position_gain ==
              about(after * after / (after * after + noise * noise)).epsilon(1e-3));
        // one that is refused weighs nothing
        settings.gate = 0.99;
        samples[1].what.position.x() = 1;
        Simulation refusing = pair(samples, 1, settings, 0.03);
        refusing.advance(40);
        REQUIRE(fusion_of(refusing).records.size() == 2);
        CHECK(fusion_of(refusing).records[1].position_gain == 0);
        CHECK(fusion_of(refusing).records[1].position_deviation == about(after).epsilon(1e-3));
        // and of the report's filter, to the letter, the gain of rotation is nothing for ever
        settings.kind = FilterKind::printed;
        for (TimedMeasurement& m : samples)
            m.what.velocity = m.what.angular_velocity = Vec3::Zero();
        Simulation printed = pair(samples, 1, settings, 0.03);
        printed.advance(40);
        REQUIRE(fusion_of(printed).records.size() == 2);
        for (const AnalysisRecord& r : fusion_of(printed).records) CHECK(r.attitude_gain == 0);
    }

    TEST_CASE("a correction over the limit of a step goes no farther than that, and the filter "
              "knows what is left") {
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
            // what was measured is known to 1e-9 m: all that is not known is what is left
            const Vec3 left = seen - before;
            const Matrix covariance = fusion_of(sim).filters[0].covariance();
            CHECK((covariance.topLeftCorner<3, 3>() - left * left.transpose()).norm() <
                  1e-9 * left.squaredNorm());
        }
    }

    TEST_CASE("a correction a hundred times over the limit is withheld: the body does not know of "
              "it, and the filter does") {
        const Vec3 seen(-1e-3, 2e-4, 0);
        Simulation sim = pair({at(3e-4, seen)}, 1, certain_motion()),
                   alone = pair({}, 1, certain_motion());
        fusion_of(sim).largest_shift = 9e-6;
        sim.advance(60);
        alone.advance(30);
        const Vec3 left = seen - value_of<Position>(alone, 0); // then and there
        alone.advance(30);
        CHECK(counted(sim, Withheld{}) == 1);
        CHECK(counted(sim, Reduced{}) == 0);
        CHECK(counted(sim, Accepted{}) == 1);
        CHECK(fingerprint(sim.snapshot(), "bodies/") == fingerprint(alone.snapshot(), "bodies/"));
        CHECK(
            (fusion_of(sim).filters[0].covariance().topLeftCorner<3, 3>() - left * left.transpose())
                .norm() < 1e-6 * left.squaredNorm());
    }

    TEST_CASE("a pull of no gain is withheld: a moving ball goes on as without it, one that was "
              "pulled is let go, and the filter knows what is left") {
        for (const bool before : {false, true}) {
            std::vector<TimedMeasurement> samples;
            if (before) samples.push_back(at(1e-4, Vec3(1e-3, 0, 0)));
            std::vector<TimedMeasurement> more = samples;
            more.push_back(at(3e-4, Vec3(-1e-3, 2e-4, 0)));
            more.back().what.velocity = Vec3(0.3, 0.2, 0.1);
            more.back().what.velocity_deviation = 1e-6;
            const FilterSettings settings{
                .position = 1, .velocity = 1, .acceleration_density = 1e-20, .gate = 1};
            Simulation sim = pair(more, 1, settings, 0.06),
                       alone = pair(samples, 1, settings, 0.06);
            for (Simulation* s : {&sim, &alone}) {
                value_of<Velocity>(*s, 0) = Vec3(0.1, 0, 0);
                fusion_of(*s).nudging = {1, 1, 0.01};
                s->advance(29);
                fusion_of(*s).budget.gain = 0;
            }
            CAPTURE(before);
            CHECK(value_of<Nudging>(sim, 0).is_active() == before);
            sim.advance(1);
            alone.advance(1);
            CHECK(value_of<Velocity>(sim, 0) == value_of<Velocity>(alone, 0));
            CHECK(fusion_work(sim.world()) == fusion_work(alone.world()));
            CHECK_FALSE(value_of<Nudging>(sim, 0).is_active());
            CHECK(fusion_of(sim).records.back().share == 0);
            CHECK(fusion_of(sim).budget.withheld == 1);
            if (!before) {
                // it takes the motion as simulated for its own, and knows it as badly as what was
                // left says
                const Matrix covariance = fusion_of(sim).filters[0].covariance();
                CHECK(std::sqrt(covariance(0, 0)) ==
                      about(std::abs(-1e-3 - value_of<Position>(sim, 0).x())).epsilon(1e-3));
                CHECK(std::sqrt(covariance(4, 4)) == about(0.2).epsilon(1e-3));
                sim.advance(30);
                alone.advance(30);
                CHECK(fingerprint(sim.snapshot(), "bodies/") ==
                      fingerprint(alone.snapshot(), "bodies/"));
            } else {
                const Vec3 velocity = value_of<Velocity>(sim, 0);
                sim.advance(30);
                CHECK(value_of<Velocity>(sim, 0) == velocity);
                CHECK(velocity.x() > 0.1);
                CHECK(value_of<Guided>(sim, 0) == 0);
                // all that it has gained was booked, to the end of the last step with a force
                CHECK(fusion_work(sim.world()) ==
                      about(0.5 * value_of<InertialMass>(sim, 0) * (velocity.squaredNorm() - 0.01))
                          .epsilon(1e-3));
            }
        }
    }

    TEST_CASE("a spinning ball that is told its turn is pulled by that turn, which spins with it") {
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
        fusion_of(sim).nudging = {1e-12, 0, 0.01}; // of no force
        sim.advance(30);
        REQUIRE(value_of<Nudging>(sim, 0).is_active());
        for (int n = 0; n < 1000; ++n) {
            sim.advance();
            const Vec3 expected = exponential_map(n * 1e-5 * angular_velocity) * turn;
            CHECK((rotation_vector(value_of<Nudging>(sim, 0).attitude) - expected).norm() < 1e-9);
        }
    }

    TEST_CASE("what is left of a correction comes with the samples after it") {
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

    TEST_CASE("two spheres that touch, told to be a radius inside each other, stop the run without "
              "a limit and not with one") {
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
        // it was pushed back out, with no more than was put in
        CHECK(value_of<Position>(limited, 0).x() < 0);
        CHECK(0.5 * value_of<InertialMass>(limited, 0) *
                  value_of<Velocity>(limited, 0).squaredNorm() <
              1.01 * fusion_work(limited.world()));
    }

    TEST_CASE("a limit that is not met and a memory that is not asked leave all bits as they are") {
        const std::vector<TimedMeasurement> samples{at(3e-4, Vec3(5e-5, 1e-5, 0)),
                                                    at(8e-4, Vec3(4e-5, 2e-5, 0))};
        Simulation plain = pair(samples, 60), other = pair(samples, 60, {.lag = 5});
        fusion_of(other).largest_shift = 1;
        plain.advance(200);
        other.advance(200);
        CHECK(fingerprint(plain.snapshot(), "bodies/") == fingerprint(other.snapshot(), "bodies/"));
        CHECK(fingerprint(plain.snapshot(), "sensors/") ==
              fingerprint(other.snapshot(), "sensors/"));
    }

    TEST_CASE(
        "samples that come late within the lag leave a flying ball where they leave it on time") {
        Simulation on_time = flight({}, 0, 0, 0);
        on_time.advance(1200);
        for (const double note_every : {0.0, 1e-3, 0.7e-3}) {
            Simulation late = flight({3, 4, 6}, 3.4e-3, 20, note_every),
                       lost = flight({3, 4, 6}, 1, 20, note_every);
            // without notes the start of what the filter knows is the first sample
            Simulation same = flight({}, 0, 20, note_every);
            late.advance(1200);
            lost.advance(1200);
            same.advance(1200);
            CAPTURE(note_every);
            CHECK(counted(late, TooLate{}) == 0);
            CHECK(counted(late, Accepted{}) == 10);
            CHECK((value_of<Position>(late, 0) - value_of<Position>(same, 0)).norm() <
                  1e-13); // of 1e-3: sums in another order
            CHECK((value_of<Velocity>(late, 0) - value_of<Velocity>(same, 0)).norm() < 1e-11);
            CHECK(
                (fusion_of(late).filters[0].covariance() - fusion_of(same).filters[0].covariance())
                    .norm() < 1e-15);
            CHECK((value_of<Position>(lost, 0) - value_of<Position>(same, 0)).norm() > 1e-6);
            if (note_every == 0)
                CHECK(value_of<Position>(same, 0) == value_of<Position>(on_time, 0));
        }
    }

    TEST_CASE("a filter that remembers knows that a pulled body was given its velocity, though not "
              "its place") {
        std::vector<TimedMeasurement> samples;
        for (const double time : {1e-4, 2e-4, 3e-4}) {
            samples.push_back(at(time, Vec3(0.001, 0, 0)));
            samples.back().what.position_deviation = 1e-3;
        }
        samples[0].what.velocity = Vec3(0.1, 0, 0);
        samples[0].what.velocity_deviation = 1e-6;
        Simulation sim =
            pair(samples, 1, {.position = 1, .velocity = 1, .gate = 1, .lag = 5}, 0.06);
        fusion_of(sim).nudging = {1, 0, 0.01}; // of no force
        sim.advance(60);
        CHECK(counted(sim, Accepted{}) == 4);
        CHECK((value_of<Velocity>(sim, 0) - Vec3(0.1, 0, 0)).norm() < 1e-4);
        CHECK(value_of<Position>(sim, 0).x() == about(5e-5).epsilon(0.05)); // flown, from 1e-4 on
    }

    TEST_CASE(
        "samples that come later than the lag, or late without one, are counted and move nothing") {
        for (const unsigned lag : {0u, 1u}) {
            Simulation late = flight({3, 4, 6}, 3.4e-3, lag, 0),
                       lost = flight({3, 4, 6}, 1, lag, 0);
            late.advance(1200);
            lost.advance(1200);
            CAPTURE(lag);
            CHECK(counted(late, TooLate{}) == 3);
            CHECK(counted(late, Accepted{}) == 7);
            CHECK(counted(lost, TooLate{}) == 0);
            if (lag == 0)
                CHECK(fingerprint(late.snapshot(), "bodies/") ==
                      fingerprint(lost.snapshot(), "bodies/"));
        }
    }

    TEST_CASE("a run resumed with samples that are late still to come has the same bits") {
        for (const std::uint64_t steps : {350u, 500u, 660u}) {
            const auto make = [] {
                Simulation sim = flight({3, 4, 6}, 3.4e-3, 20, 0.7e-3);
                fusion_of(sim).largest_shift = 3e-4;
                return sim;
            };
            Simulation whole = make(), resumed = make();
            whole.advance(steps);
            resumed.restore(whole.snapshot());
            whole.advance(1200 - steps);
            resumed.advance(1200 - steps);
            CAPTURE(steps);
            CHECK(counted(whole, Reduced{}) > 0);
            CHECK(counted(whole, TooLate{}) == 0);
            CHECK(fingerprint(whole.snapshot()) == fingerprint(resumed.snapshot()));
        }
    }

    TEST_CASE("sensors need hosts of their own, and samples in order") {
        World world = make_world(Grains::spheres);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1, 1}, {{}, {}}, {}),
                             doctest::Contains("one for each host"), InputError);
        CHECK_THROWS_WITH_AS(
            add_sensors(world, {1}, {{at(2, Vec3::Zero()), at(1, Vec3::Zero())}}, {}),
            doctest::Contains("order of arrival"), InputError);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1}, {{{2, {}, 1}}}, {}),
                             doctest::Contains("arrive after their time"), InputError);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1}, {}, {}), doctest::Contains("found 0"),
                             InputError);
    }
}
