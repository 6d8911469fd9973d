#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "systems/experiments/bench.hpp"
#include "systems/experiments/collide.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"

#include <doctest/doctest.h>

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

TimedMeasurement at(double time, const Vec3& position) {
    TimedMeasurement m{time, {}};
    m.what.position = position;
    m.what.position_deviation = 1e-9;
    return m;
}

/// Of a place that is not known at all, and a velocity that is.
FilterSettings certain_motion() { return {.position = 1, .velocity = 1e-12, .acceleration_density = 1e-20}; }

/// Two balls that rest against each other, without weight; the first has a sensor.
Simulation pair(std::vector<TimedMeasurement> samples, unsigned injection_steps, FilterSettings settings = {}, double distance = 0.0199) {
    World world = make_world(Grains::spheres);
    const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
    world.resource<Materials>().mix();
    (void)add_sphere(world, Vec3(0, 0, 0), 0.01, m);
    (void)add_sphere(world, Vec3(distance, 0, 0), 0.01, m, Motion::fixed);
    add_sensors(world, {0}, {std::move(samples)}, settings, injection_steps);
    return begin(std::move(world), LawName::linear, 1e-5);
}

} // namespace

TEST_SUITE("systems/fusion/fuse") {
    TEST_CASE("what the sensor of one ball tells, contact carries to the other, as momentum conservation says") {
        for (const double offset : {0.0, 0.7}) {
            Collide c = game();
            c.offset = offset;
            c.sampling_rate = 30;      // few samples: an error is left
            c.velocity_noise = 0.02;
            c.position_noise = -1;     // not measured: nothing jumps
            const CollideResult r = measure(c);
            CAPTURE(offset);
            CHECK(r.fused_error < 0.5 * r.free_error);
            CHECK(std::abs(r.error_at_touch) > 1e-3);
            if (offset == 0) CHECK(r.carried_error == doctest::Approx(r.expected_error).epsilon(0.02));
            CHECK(std::abs(r.energy_open) < 1e-3 * std::abs(r.fusion_work));
        }
    }

    TEST_CASE("with a good sensor hardly any error is left, of one ball or of many") {
        for (const unsigned balls : {2u, 7u}) {
            Collide c = game();
            c.balls = balls;
            c.position_noise = 1e-6;
            c.velocity_noise = 1e-5;
            const CollideResult r = measure(c);
            CAPTURE(balls);
            CHECK(r.free_error > 0.01);
            CHECK(r.fused_error < 0.02 * r.free_error);
            CHECK(r.refused < r.accepted / 10);
        }
    }

    TEST_CASE("what happens within a touch a sensor cannot mend: another restitution leaves its error in the other ball") {
        Collide c = game();
        c.model_speed = 1;
        c.model_restitution = 0.5;
        const CollideResult r = measure(c);
        CHECK(r.fused_error == doctest::Approx(r.free_error).epsilon(0.05));
        CHECK(r.free_error == doctest::Approx(0.5 * (0.9 - 0.5)).epsilon(0.02));
    }

    TEST_CASE("a correction arrives whole, at once or in steps, and leaves no velocity behind") {
        for (const unsigned steps : {1u, 50u}) {
            Simulation sim = pair({at(3e-4, Vec3(-1e-3, 2e-4, 0))}, steps, certain_motion(), 0.03);
            sim.advance(30);
            CHECK(value_of<Position>(sim, 0).norm() == 0); // the sample is taken at the end of this step
            sim.advance(steps / 2);
            CHECK(value_of<Position>(sim, 0).x() == doctest::Approx(steps == 1 ? 0 : -0.5e-3).epsilon(1e-3));
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
        const Vec3 now = value_of<Velocity>(sim, 0) - Vec3(0.5e-5 * kn * overlap / value_of<InertialMass>(sim, 0), 0, 0);
        const double energy = 0.5 * kn * overlap * overlap + 0.5 * value_of<InertialMass>(sim, 0) * now.squaredNorm();
        CHECK(fusion_work(sim.world()) > 0.1 * before);
        CHECK(energy - before == doctest::Approx(fusion_work(sim.world())).epsilon(0.01));
    }

    TEST_CASE("with all sensors dead the bodies move as without any, to the last bit") {
        const auto positions = [](bool with_sensors) {
            World world = make_world(Grains::spheres);
            const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
            world.resource<Materials>().mix();
            Random random(1, 0);
            for (int k = 0; k < 60; ++k) (void)add_sphere(world, Vec3(0.021 * (k % 4), 0.021 * (k / 4 % 4), 0.02 + 0.021 * (k / 16)), 0.01 + 1e-4 * random.uniform(), m);
            (void)add_floor(world, m);
            world.add_resource<Gravity>();
            if (with_sensors) add_sensors(world, {3, 17}, {{}, {}}, {}, 10);
            Simulation sim = begin(std::move(world), LawName::linear, 2e-5);
            sim.advance(2000);
            return fingerprint(sim.snapshot(), "bodies/position");
        };
        CHECK(positions(true) == positions(false));
    }

    TEST_CASE("a run resumed between a sample and the end of its correction has the same bits") {
        const std::vector<TimedMeasurement> samples{at(3e-4, Vec3(5e-5, 1e-5, 0)), at(8e-4, Vec3(4e-5, 2e-5, 0))};
        Simulation whole = pair(samples, 60), resumed = pair(samples, 60);
        whole.advance(50);
        resumed.restore(whole.snapshot());
        whole.advance(100);
        resumed.advance(100);
        CHECK(fingerprint(whole.snapshot()) == fingerprint(resumed.snapshot()));
    }

    TEST_CASE("a scene without sensors has none of fusion in its schedule, and says so") {
        World world = make_world(Grains::spheres);
        (void)add_sphere(world, Vec3::Zero(), 0.01, world.resource<Materials>().add(linear_material(1e5)));
        world.resource<Materials>().mix();
        const Simulation sim = begin(std::move(world), LawName::linear, dt);
        const Simulation fused = pair({at(1, Vec3::Zero())}, 1);
        const auto runs = [](const Simulation& s, const std::string& system) {
            const std::string text = const_cast<Simulation&>(s).schedule().explain();
            const auto line = text.find(system);
            REQUIRE(line != std::string::npos);
            return text.substr(line, text.find('\n', line) - line).find("no sensors") == std::string::npos &&
                   text.substr(line, text.find('\n', line) - line).find("no bodies.correction") == std::string::npos;
        };
        CHECK_FALSE(runs(sim, "fuse_spheres"));
        CHECK_FALSE(runs(sim, "shift_corrections"));
        CHECK(runs(fused, "fuse_spheres"));
        CHECK(runs(fused, "shift_corrections"));
    }

    TEST_CASE("a sensor that says what cannot be is refused, counted, and moves nothing") {
        Simulation sim = pair({at(1e-4, Vec3(1, 0, 0)), at(2e-4, Vec3(std::numeric_limits<double>::infinity(), 0, 0))}, 1, {.position = 1e-4});
        sim.advance(40);
        CHECK(sim.world().column<Sensors, Refused>()[0] == 1);  // what is not a number was not measured
        CHECK(sim.world().column<Sensors, Accepted>()[0] == 0);
        CHECK(sim.world().column<Sensors, LargestInnovation>()[0] > 1e6);
        CHECK(fusion_work(sim.world()) == 0);
    }

    TEST_CASE("sensors need hosts of their own, and samples in order") {
        World world = make_world(Grains::spheres);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1, 1}, {{}, {}}, {}), doctest::Contains("one for each host"), InputError);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1}, {{at(2, Vec3::Zero()), at(1, Vec3::Zero())}}, {}), doctest::Contains("order of time"), InputError);
        CHECK_THROWS_WITH_AS(add_sensors(world, {1}, {}, {}), doctest::Contains("found 0"), InputError);
    }
}
