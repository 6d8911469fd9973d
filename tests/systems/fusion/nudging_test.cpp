#include "engine/signal/attitude.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/loads/nudging.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

constexpr double w = 1000; // rad/s, of the springs below
constexpr double boundless = 1e9;

/// A ball of radius 1 cm at the origin with a sensor without samples, and a fixed ball at distance
/// `other` (m).
Simulation ball(double dt, double other = 1, bool energy_budget = false) {
    World world = make_world(Grains::spheres);
    const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
    world.resource<Materials>().mix();
    (void)add_sphere(world, Vec3::Zero(), 0.01, m);
    (void)add_sphere(world, Vec3(other, 0, 0), 0.01, m, Motion::fixed);
    add_sensors(world, {0}, {{}}, {});
    return begin(
        std::move(world),
        {.dt = dt, .law = LawName::linear, .energy_budget = energy_budget, .unlimited = true});
}

Simulation rock(double dt) {
    World world = make_world(Grains::clumps);
    const auto m = world.resource<Materials>().add(linear_material(1e5, 8e4, 0.5));
    world.resource<Materials>().mix();
    (void)add_clump(world, scaled(small_rock(), 0.01), 0, Vec3::Zero(),
                    exponential_map(Vec3(0.2, -0.4, 0.3)), m);
    add_sensors(world, {0}, {{}}, {});
    return begin(std::move(world), {.dt = dt, .law = LawName::linear, .unlimited = true});
}

double mass_of(Simulation& sim) { return value_of<InertialMass>(sim, 0); }
NudgingRow& nudging_of(Simulation& sim) { return value_of<Nudging>(sim, 0); }

void nudge_to(Simulation& sim, const NudgingTarget& target, const NudgingSettings& settings) {
    set_nudging(nudging_of(sim), value_of<Guided>(sim, 0), target, settings);
}

/// Nudges from rest to a target at `displacement`; the stored velocity is that of half a step back.
void nudge_from_rest(Simulation& sim, const Vec3& displacement, double largest_force) {
    const double m = mass_of(sim), k = m * w * w;
    nudge_to(
        sim,
        {value_of<Position>(sim, 0) + displacement, Vec3::Zero(), Quat::Identity(), Vec3::Zero()},
        {k, largest_force, 0.01});
    const double force = std::min(k * displacement.norm(), largest_force);
    value_of<Velocity>(sim, 0) =
        -0.5 * sim.world().resource<Clock>().dt * force / m * displacement.normalized();
}

double still_to_go(double t) { return (1 + w * t) * std::exp(-w * t); }

/// Largest error of the displacement of a ball to a target at 1 mm, relative to 1 mm.
double error_of_way(double dt) {
    Simulation sim = ball(dt);
    const Vec3 displacement = 1e-3 * Vec3(0.6, 0, -0.8);
    nudge_from_rest(sim, displacement, boundless);
    double worst = 0, last = 0;
    for (int n = 1; n * dt < 0.015; ++n) {
        sim.advance();
        const Vec3 x = value_of<Position>(sim, 0);
        const double made = x.dot(displacement) / displacement.squaredNorm();
        CHECK(made <= 1); // no overshoot
        CHECK(made >= last);
        CHECK((x - made * displacement).norm() < 1e-12);
        worst = std::max(worst, std::abs(1 - made - still_to_go(n * dt)));
        last = made;
    }
    CHECK(last > 0.999);
    return worst;
}

/// The same for a rotation by 0.4 rad about a principal axis of a rock. The lever arm is 1 m, with
/// a stiffness for which the angular frequency is w too.
double error_of_turn(int axis, double dt) {
    Simulation sim = rock(dt);
    const double inertia = value_of<InertialInertia>(sim, 0)[axis], angle = 0.4,
                 k = inertia * w * w;
    const Quat start = value_of<Orientation>(sim, 0);
    const Vec3 about_axis = start * Vec3(Vec3::Unit(axis));
    const Quat goal = exponential_map(angle * about_axis) * start;
    nudge_to(sim, {Vec3::Zero(), Vec3::Zero(), goal, Vec3::Zero()}, {k, boundless, 1});
    value_of<AngularMomentum>(sim, 0) = -0.5 * dt * k * angle * about_axis;
    double worst = 0;
    for (int n = 1; n * dt < 0.015; ++n) {
        sim.advance();
        const Vec3 left = attitude_error(goal, value_of<Orientation>(sim, 0));
        CHECK(left.dot(about_axis) >= -1e-12); // no overshoot
        CHECK((left - left.dot(about_axis) * about_axis).norm() < 1e-9);
        worst = std::max(worst, std::abs(left.dot(about_axis) / angle - still_to_go(n * dt)));
    }
    return worst;
}

void release_nudging(NudgingRow& row) { row.stiffness = row.turn_stiffness = 0; }

} // namespace

TEST_SUITE("fusion/nudging") {
    TEST_CASE("a nudged free ball approaches its target as a critically damped body does, without "
              "overshoot and with an error of second order in the step") {
        const double coarse = error_of_way(1e-4), fine = error_of_way(5e-5),
                     finer = error_of_way(2.5e-5);
        CHECK(coarse < 0.2 * std::pow(w * 1e-4, 2));
        CHECK(coarse / fine == about(4).epsilon(0.1));
        CHECK(fine / finer == about(4).epsilon(0.05));
    }

    TEST_CASE("a free rock rotates in this way about each of its principal axes") {
        for (int axis = 0; axis < 3; ++axis) {
            CAPTURE(axis);
            const double coarse = error_of_turn(axis, 1e-4), fine = error_of_turn(axis, 5e-5);
            CHECK(coarse < 0.2 * std::pow(w * 1e-4, 2));
            CHECK(coarse / fine == about(4).epsilon(0.1));
        }
    }

    TEST_CASE("a sphere, which has no attitude, is rotated by the given angle") {
        const double dt = 2e-5, angle = 0.3;
        Simulation sim = ball(dt);
        const double inertia = value_of<SphereInertia>(sim, 0), k = inertia * w * w;
        const Vec3 axis(0.6, 0, 0.8);
        nudge_to(sim, {Vec3::Zero(), Vec3::Zero(), exponential_map(angle * axis), Vec3::Zero()},
                 {k, boundless, 1});
        value_of<AngularMomentum>(sim, 0) = -0.5 * dt * k * angle * axis;
        Vec3 turned = Vec3::Zero();
        for (int n = 1; n * dt < 0.015; ++n) {
            sim.advance();
            turned += dt * value_of<StepAngularVelocity>(sim, 0);
            CHECK(std::abs(1 - turned.dot(axis) / angle - still_to_go(n * dt)) <
                  0.2 * std::pow(w * dt, 2));
        }
        CHECK((turned - angle * axis).norm() < 1e-4);
    }

    TEST_CASE("a sphere is rotated to a target attitude that itself rotates about another axis") {
        // the target is ahead by a rotation about x and rotates about z; the rotation of the ball
        // itself is integrated here
        const double dt = 1e-5;
        const Vec3 angular_velocity(0, 0, 100);
        const Quat start = exponential_map(Vec3(0.3, 0, 0));
        Simulation sim = ball(dt);
        const double k = value_of<SphereInertia>(sim, 0) * w * w;
        nudge_to(sim,
                 {Vec3::Zero(), Vec3::Zero(), exponential_map(-dt * angular_velocity) * start,
                  angular_velocity},
                 {k, boundless, 1});
        Quat attitude = Quat::Identity();
        const auto goal = [&](int n) { return exponential_map(n * dt * angular_velocity) * start; };
        double worst = 0;
        for (int n = 1; n <= 2000; ++n) {
            sim.advance();
            // the torque of this step was computed before it rotated the ball
            worst = std::max(
                worst, attitude_error(goal(n - 1) * attitude.conjugate(), nudging_of(sim).attitude)
                           .norm());
            attitude = exponential_map(dt * value_of<StepAngularVelocity>(sim, 0)) * attitude;
        }
        CHECK(worst < 1e-12);
        CHECK(attitude_error(goal(2000), attitude).norm() < 1e-6);
        CHECK((value_of<StepAngularVelocity>(sim, 0) - angular_velocity).norm() < 1e-3);
    }

    TEST_CASE("with scaled mass and inertia the motion is as critically damped, on the time scale "
              "of the scaled mass") {
        const double dt = 1e-4, scale = 9;
        Simulation light = ball(dt / 3), heavy = ball(dt);
        value_of<InertialMass>(heavy, 0) *= scale;
        for (Simulation* sim : {&light, &heavy})
            nudge_to(*sim, {Vec3(1e-3, 0, 0), Vec3::Zero(), Quat::Identity(), Vec3::Zero()},
                     {mass_of(light) * w * w, boundless, 0.01});
        for (int n = 0; n < 300; ++n) {
            light.advance();
            heavy.advance();
            CHECK(std::abs(value_of<Position>(light, 0).x() - value_of<Position>(heavy, 0).x()) <
                  1e-15);
            CHECK(value_of<Position>(heavy, 0).x() <= 1e-3);
        }
    }

    TEST_CASE("a spring stiffer than the step allows is reduced to one that the step resolves, so "
              "there is no overshoot at any stiffness") {
        for (const double stiffness : {1e2, 1e5, 1e9, 1e13}) {
            Simulation sim = ball(1e-4);
            nudge_to(
                sim,
                {Vec3(1e-3, 0, 0), Vec3::Zero(), exponential_map(Vec3(0, 0, 0.1)), Vec3::Zero()},
                {stiffness, boundless, 0.01});
            double turned = 0;
            for (int n = 0; n < 2000; ++n) {
                sim.advance();
                turned += 1e-4 * value_of<StepAngularVelocity>(sim, 0).z();
                CHECK(value_of<Position>(sim, 0).x() <= 1e-3 * (1 + 1e-12));
                CHECK(turned <= 0.1 * (1 + 1e-9));
            }
            CAPTURE(stiffness);
            CHECK(value_of<Position>(sim, 0).x() == about(1e-3).epsilon(1e-6));
        }
    }

    TEST_CASE("with a limited force a distant ball approaches at the speed that the dashpot "
              "allows, as in the closed form, and stops at its target") {
        const double dt = 1e-5, largest = 0.02;
        Simulation sim = ball(dt);
        const double m = mass_of(sim), reach = largest / (m * w * w), speed = 0.5 * w * reach,
                     displacement = 50 * reach;
        nudge_from_rest(sim, Vec3(displacement, 0, 0), largest);
        double time = 0;
        for (int n = 0; value_of<Position>(sim, 0).x() < displacement - reach; ++n) {
            REQUIRE(n < 100000);
            sim.advance();
            time += dt;
            const double exact = speed * (time + std::expm1(-2 * w * time) / (2 * w));
            CHECK(std::abs(value_of<Position>(sim, 0).x() - exact) < 1e-3 * reach);
        }
        for (int n = 0; n < 3000; ++n) {
            sim.advance();
            CHECK(value_of<Position>(sim, 0).x() <= displacement * (1 + 1e-12));
            CHECK(nudging_of(sim).force.norm() <= largest);
        }
        CHECK(value_of<Position>(sim, 0).x() == about(displacement).epsilon(1e-9));
    }

    TEST_CASE(
        "force and torque never exceed their limits, for any velocity and any target of a rock") {
        Simulation sim = rock(2e-5);
        value_of<Velocity>(sim, 0) = Vec3(-30, 10, 5);
        set_angular_velocity(sim.world(), 0, Vec3(300, -100, 200));
        const NudgingSettings settings{1e4, 0.5, 0.004};
        nudge_to(sim,
                 {Vec3(0.05, 0.02, -0.01), Vec3(1, 0, 0), exponential_map(Vec3(0, 1.5, 0.5)),
                  Vec3(0, 0, 20)},
                 settings);
        double largest_force = 0, largest_torque = 0;
        for (int n = 0; n < 5000; ++n) {
            const Vec3 before = value_of<Velocity>(sim, 0);
            sim.advance();
            CHECK((value_of<Velocity>(sim, 0) - before).norm() * mass_of(sim) / 2e-5 <
                  settings.largest_force * (1 + 1e-9)); // nothing else acts
            largest_force = std::max(largest_force, nudging_of(sim).force.norm());
            largest_torque = std::max(largest_torque, nudging_of(sim).torque.norm());
        }
        CHECK(largest_force == about(settings.largest_force).epsilon(1e-12));
        CHECK(largest_torque == about(settings.largest_force * settings.arm).epsilon(1e-12));
    }

    TEST_CASE("a ball follows a moving target") {
        Simulation sim = ball(1e-5);
        const Vec3 goal_position(1e-4, 0, 0), velocity(0.05, 0.02, 0);
        nudge_to(sim, {goal_position, velocity, Quat::Identity(), Vec3::Zero()},
                 {mass_of(sim) * w * w, boundless, 0.01});
        sim.advance(3000);
        CHECK((value_of<Position>(sim, 0) - (goal_position + 0.03 * velocity)).norm() < 1e-9);
    }

    TEST_CASE("the work of spring and dashpot is accumulated, and the error of the energy balance "
              "decreases with the step") {
        // two balls in contact, one of them fixed: the other is nudged against it and along it,
        // held with a constant force, released, and flies off
        const auto open = [](double dt) {
            Simulation sim = ball(dt, 0.02, true);
            nudge_to(sim,
                     {Vec3(2e-4, 1e-4, 0), Vec3::Zero(), exponential_map(Vec3(0, 0, 0.02)),
                      Vec3::Zero()},
                     {4e4, 8, 0.01});
            const auto run = [&](double time) {
                sim.advance(static_cast<std::uint64_t>(std::llround(time / dt)));
            };
            run(1e-3);
            CHECK(touch_of(sim.world()).pairs == 1);
            hold_nudging_forces(sim.world());
            run(1e-3);
            release_nudging(nudging_of(sim));
            run(4e-3);
            CHECK(touch_of(sim.world()).pairs == 0);
            CHECK(value_of<Guided>(sim, 0) == 0);
            const double friction = value_of<FrictionWork>(sim, 0) + value_of<FrictionWork>(sim, 1),
                         work = fusion_work(sim.world());
            CHECK(friction > 0.01 * work);
            return std::abs(compute_quantities(sim.world()).kinetic_energy + friction - work) /
                   work;
        };
        // between first and second order, because the error depends on when friction begins to slip
        CHECK(open(1.6e-5) < 1e-4);
        CHECK(open(5e-7) < 2e-6);
    }

    TEST_CASE("a run resumed while a rock is nudged, held or just released has the same bits") {
        const auto make = [] {
            Simulation sim = rock(2e-5);
            nudge_to(sim,
                     {Vec3(1e-3, 2e-4, 0), Vec3(0.01, 0, 0), exponential_map(Vec3(0, 0.5, 0)),
                      Vec3(0, 0, 1)},
                     {1e3, 0.1, 0.01});
            return sim;
        };
        for (const int when : {0, 1, 2}) {
            Simulation whole = make(), resumed = make();
            whole.advance(100);
            if (when == 1) hold_nudging_forces(whole.world());
            if (when == 2) release_nudging(nudging_of(whole));
            resumed.restore(whole.snapshot());
            whole.advance(100);
            resumed.advance(100);
            CAPTURE(when);
            CHECK(fingerprint(whole.snapshot()) == fingerprint(resumed.snapshot()));
            CHECK((nudging_of(whole).force.norm() > 0) == (when < 2));
        }
    }
}
