#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("physics/free_motion") {
    TEST_CASE("a body in free fall follows the parabola of the leapfrog") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            World world = make_world(grains);
            const auto material = add_material(world, linear_material(1e5));
            const EntityId ball = grains == Grains::spheres
                                      ? add_sphere(world, Vec3(1, 2, 3), 0.01, material)
                                      : add_clump(world, scaled(small_rock(), 0.02), 0,
                                                  Vec3(1, 2, 3), Quat(Quat::Identity()), material);
            const Vec3 v(0.3, -0.2, 1);
            const double dt = 1e-4, g = 9.81;
            // v(0) = v means v(-dt/2) = v + g dt/2
            value_of<Velocity>(world, ball) = v + Vec3(0, 0, g * dt / 2);
            world.add_resource<Gravity>();
            Simulation sim = begin(std::move(world), {.dt = dt});
            sim.advance(5000);
            const double t = 0.5;
            const Vec3 exact = Vec3(1, 2, 3) + t * v - Vec3(0, 0, 0.5 * g * t * t);
            // 5000 additions, each rounded by eps times the position
            CHECK((value_of<Position>(sim, ball) - exact).norm() < 5000 * 1.1e-16 * 4);
            CHECK(sim.world().resource<Clock>().time() == about(t).epsilon(1e-15));
        }
    }

    TEST_CASE("a sliding block decelerates at mu g") {
        const double friction = 0.3, g = 9.81, dt = 2e-6;
        World world = make_world(Grains::clumps);
        Material m = linear_material(1e6, 5e5, friction);
        m.normal_damping = m.shear_damping = 3000; // damps the pitching at the beginning of sliding
        const auto material = add_material(world, m);
        add_floor(world, material);
        std::vector<Ball> feet;
        for (const double x : {-1.0, 1.0})
            for (const double y : {-1.0, 1.0}) feet.push_back({Vec3(0.02 * x, 0.02 * y, 0), 0.005});
        const Clump block = make_clump("block", feet);
        const EntityId body =
            add_clump(world, block, 0, Vec3(0, 0, 0.005), Quat(Quat::Identity()), material);
        value_of<Velocity>(world, body) = Vec3(1, 0, 0);
        world.add_resource<Gravity>();
        Simulation sim = begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
        sim.advance(5000); // the springs have reached the Coulomb limit
        const Vec3 before = value_of<Velocity>(sim, body);
        sim.advance(20'000);
        const Vec3 change = value_of<Velocity>(sim, body) - before;
        const double time = 20'000 * dt;
        // friction is mu N at every foot in every step, so dv_x + mu dv_z = -mu g t for any N;
        // 20000 roundings of v ~ 1 m/s
        CHECK(std::abs(change.x() + friction * change.z() + friction * g * time) <
              20'000 * 1.1e-16 * 4);
        CHECK(change.x() == about(-friction * g * time).epsilon(1e-4)); // remaining pitching
        CHECK(std::abs(change.y()) < 1e-9);
    }

    TEST_CASE("a sphere launched horizontally slips for 2/7 v0/(mu g), then rolls at 5/7 v0") {
        const double radius = 0.01, v0 = 0.1, g = 9.81, dt = 1e-5;
        for (const double friction : {0.2, 0.5, 1.0}) {
            World world = make_world(Grains::spheres);
            Material m = linear_material(1e6, 8e5, friction);
            m.normal_damping = m.shear_damping = 2000;
            const auto material = add_material(world, m);
            add_floor(world, material);
            const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
            const double overlap = value_of<Mass>(world, ball) * g / 1e6; // 1e-5 of the radius
            value_of<Position>(world, ball) = Vec3(0, 0, radius - overlap);
            value_of<Velocity>(world, ball) = Vec3(v0, 0, 0);
            world.add_resource<Gravity>();
            Simulation sim = begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
            const double slip_time = 2.0 / 7 * v0 / (friction * g);
            double stopped = 0;
            while (sim.world().resource<Clock>().time() < 3 * slip_time) {
                sim.advance();
                const auto pairs = touching_pairs<PlanePairs>(sim.world());
                REQUIRE(pairs.size() == 1);
                const ForceRow& f = pairs[0].force;
                const double shear = std::hypot(f.fx, f.fy);
                // the Coulomb limit holds in every step
                CHECK(shear <= friction * f.normal_force * (1 + 1e-14));
                const double t = sim.world().resource<Clock>().time();
                if (stopped == 0 && t > 0.1 * slip_time &&
                    shear < friction * f.normal_force * (1 - 1e-9))
                    stopped = t;
            }
            CAPTURE(friction);
            const double speed = value_of<Velocity>(sim, ball).x(),
                         rim = radius * value_of<AngularVelocity>(sim, ball).y();
            MESSAGE("mu ", friction, ": relative error of slip time ", stopped / slip_time - 1,
                    ", of speed ", speed / v0 * 7 / 5 - 1);
            // time to 5e-3 (a step is 1e-3 to 5e-3 of it), speed to 2e-4 (the lever arm is R -
            // overlap/2)
            CHECK(std::abs(stopped / slip_time - 1) < 5e-3 + 2 * dt / slip_time);
            CHECK(std::abs(speed / v0 - 5.0 / 7) < 2e-4 * 5 / 7);
            CHECK(std::abs(rim / v0 - 5.0 / 7) < 2e-4 * 5 / 7);
        }
    }

    TEST_CASE("a cloud of colliding grains without walls conserves linear and angular momentum") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            World world = make_world(grains);
            Material m = linear_material(1e5, 5e4, 0.5);
            m.normal_damping = m.shear_damping = 500;
            const auto material = add_material(world, m);
            Random random(17, 1);
            const Clump rock = scaled(small_rock(), 0.018);
            for (int k = 0; k < 64; ++k) {
                const Vec3 position = 0.024 * Vec3(k % 4, k / 4 % 4, k / 16);
                const EntityId id =
                    grains == Grains::spheres
                        ? add_sphere(world, position, 0.01, material)
                        : add_clump(world, rock, 0, position, random.rotation(), material);
                // all grains move towards the centre
                value_of<Velocity>(world, id) =
                    -40 * (position - Vec3::Constant(0.036)) + 0.3 * random.direction();
                set_angular_velocity(world, id, 50 * random.direction());
            }
            Simulation sim = begin(std::move(world), {.dt = 5e-6, .law = LawName::linear_viscous});
            const auto totals = [&] {
                const World& w = sim.world();
                std::pair<Vec3, Vec3> sum{Vec3::Zero(), Vec3::Zero()};
                for (std::size_t b = 0; b < 64; ++b) {
                    const Vec3 p =
                        w.column<Bodies, InertialMass>()[b] * w.column<Bodies, Velocity>()[b];
                    sum.first += p;
                    // x(t) x v(t - dt/2) + L(t - dt/2) is the quantity that the leapfrog conserves
                    sum.second += w.column<Bodies, Position>()[b].cross(p) +
                                  w.column<Bodies, AngularMomentum>()[b];
                }
                return sum;
            };
            double scale = 0, turning_scale = 0;
            for (EntityId b = 0; b < 64; ++b) {
                scale += value_of<InertialMass>(sim, b) * value_of<Velocity>(sim, b).norm();
                turning_scale += value_of<AngularMomentum>(sim, b).norm() +
                                 value_of<InertialMass>(sim, b) * 0.05;
            }
            const auto before = totals();
            std::size_t touched = 0;
            for (int k = 0; k < 20; ++k) {
                sim.advance(100);
                touched += touching_pairs<SpherePairs>(sim.world()).size();
            }
            const auto after = totals();
            REQUIRE(touched > 100);
            // each of 2000 steps rounds each of 64 momenta once or twice
            CHECK((after.first - before.first).norm() < 2000 * 1.1e-16 * scale);
            CHECK((after.second - before.second).norm() < 2000 * 1.1e-16 * turning_scale);
        }
    }

    TEST_CASE("a dumbbell that falls horizontally rebounds horizontally") {
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
        add_floor(world, material);
        const std::vector<Ball> balls{{Vec3(-0.01, 0, 0), 0.008}, {Vec3(0.01, 0, 0), 0.008}};
        const Clump dumbbell = make_clump("dumbbell", balls);
        const EntityId body =
            add_clump(world, dumbbell, 0, Vec3(0, 0, 0.01), Quat(Quat::Identity()), material);
        value_of<Velocity>(world, body) = Vec3(0, 0, -1);
        const double mass = value_of<Mass>(world, body), dt = pi / std::sqrt(2 * 1e5 / mass) / 200;
        Simulation sim = begin(std::move(world), {.dt = dt});
        sim.advance(static_cast<std::uint64_t>(0.002 / dt) + 100);
        sim.advance(300);
        REQUIRE(touching_pairs<PlanePairs>(sim.world()).empty());
        REQUIRE(value_of<Position>(sim, body).z() > 0.008);
        // both balls touch: a contact of t_c/200 restores the speed to 2 (omega dt)^2/8
        CHECK(std::abs(value_of<Velocity>(sim, body).z() - 1) < 2 * pi * pi / (8 * 200 * 200));
        // the principal frame of make_clump is known to the accuracy of its quadrature; the
        // remainder is rounding of the two lever arms
        CHECK(value_of<AngularVelocity>(sim, body).norm() * 0.01 < 1e-9);
    }

    TEST_CASE("a clump of one sphere bounces, slides and spins as a single sphere does") {
        const auto simulate = [](Grains grains) {
            World world = make_world(grains);
            Material m = linear_material(1e5, 8e4, 0.4);
            m.normal_damping = m.shear_damping = 800;
            const auto material = add_material(world, m);
            add_floor(world, material);
            const double radius = 0.01, volume = 4 * pi / 3 * radius * radius * radius;
            const Clump one{.name = "one",
                            .balls = {{Vec3::Zero(), radius}},
                            .volume = volume,
                            .inertia = Vec3::Constant(0.4 * volume * radius * radius),
                            .bounding_radius = radius,
                            .sieve = 2 * radius};
            const Vec3 position(0, 0, 1.01 * radius);
            const EntityId body = grains == Grains::spheres
                                      ? add_sphere(world, position, radius, material)
                                      : add_clump(world, one, 0, position,
                                                  exponential_map(Vec3(0.5, 0.2, -1)), material);
            value_of<Velocity>(world, body) = Vec3(0.3, -0.1, -0.5);
            set_angular_velocity(world, body, Vec3(20, 30, -15));
            world.add_resource<Gravity>();
            world.add_resource(LocalDamping{0.1});
            return std::pair(begin(std::move(world), {.dt = 5e-6, .law = LawName::linear_viscous}),
                             body);
        };
        auto [sphere, a] = simulate(Grains::spheres);
        auto [clump, b] = simulate(Grains::clumps);
        std::size_t touched = 0;
        for (int k = 0; k < 60; ++k) {
            sphere.advance(10);
            clump.advance(10);
            touched += touching_pairs<PlanePairs>(sphere.world()).size();
            const Vec3 spin = value_of<AngularVelocity>(sphere, a);
            CHECK((value_of<Position>(sphere, a) - value_of<Position>(clump, b)).norm() < 1e-12);
            CHECK((value_of<Velocity>(sphere, a) - value_of<Velocity>(clump, b)).norm() < 1e-10);
            CHECK((spin - value_of<AngularVelocity>(clump, b)).norm() < 1e-10 * spin.norm());
        }
        CHECK(touched > 5);
        CHECK(value_of<Velocity>(sphere, a).z() > 0); // it has rebounded
    }
}
