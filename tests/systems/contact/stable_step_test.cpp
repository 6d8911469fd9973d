#include "engine/random.hpp"
#include "systems/contact/stable_step.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double radius = 0.01, kn = 1e5;

/// Estimate of the stable step (s) after one negligible step that finds the contacts.
double estimate(Simulation& sim) {
    sim.world().resource<Clock>().dt = 1e-12;
    sim.advance();
    return stable_step(sim.world());
}

/// A sphere that rests on a floor, slightly displaced from its equilibrium.
Simulation on_floor(double ks, double dt) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(kn, ks, 1e6));
    add_floor(world, material);
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
    const double overlap = value_of<Mass>(world, ball) * 1000 / kn;
    value_of<Position>(world, ball) = Vec3(0, 0, radius - 1.001 * overlap);
    value_of<Velocity>(world, ball) = Vec3(1e-5, 0, 0);
    world.add_resource<Gravity>({Vec3(0, 0, -1000)});
    return begin(std::move(world), {.dt = dt});
}

/// Whether the motion of a body stays bounded for 300 steps.
bool stays_small(Simulation& sim, EntityId body, double dt) {
    const Vec3 begin = value_of<Position>(sim, body);
    sim.world().resource<Clock>().dt = dt;
    try {
        for (int k = 0; k < 300; ++k) {
            sim.advance();
            // the initial displacement is 1e-3 of the overlap, so this is far beyond any bounded
            // motion
            if ((value_of<Position>(sim, body) - begin).norm() > 0.02 * radius) return false;
        }
    } catch (const std::exception&) {
        return false;
    }
    return true;
}

/// Ratio of the estimate to the exact limit for two free spheres that touch.
double pair_estimate(double ratio) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(kn, ratio * kn, 1));
    const EntityId a = add_sphere(world, Vec3(0, 0, 0), radius, material);
    add_sphere(world, Vec3(0, 0, 1.9999 * radius), radius, material);
    const double mass = value_of<Mass>(world, a);
    Simulation sim = begin(std::move(world), {});
    // sqrt(2) sqrt(m/kn), and 2/sqrt(7) = 0.7559 times sqrt(m/ks)
    const double limit =
        std::min(std::sqrt(2 * mass / kn),
                 ratio > 0 ? 2 / std::sqrt(7.0) * std::sqrt(mass / (ratio * kn)) : 1.0);
    return estimate(sim) / limit;
}

/// The least stable step (s) of the spheres at these places, without any bounds: from the largest
/// eigenvalue of the 6 x 6 matrix of each, with twice the stiffness of its contacts, as their
/// partners move too.
double least_step_of_all(std::span<const Vec3> places, double ks, double mass, double inertia) {
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    Eigen::Matrix<double, 6, 1> root;
    root << Vec3::Constant(1 / std::sqrt(mass)), Vec3::Constant(1 / std::sqrt(inertia));
    double largest = 0;
    for (const Vec3& x : places) {
        Mat6 sum = Mat6::Zero();
        for (const Vec3& y : places) {
            const double apart = (y - x).norm();
            if (apart == 0 || apart >= 2 * radius) continue;
            const Vec3 n = (y - x) / apart, arm = apart / 2 * n;
            Eigen::Matrix<double, 3, 6> moves;
            for (Eigen::Index k = 0; k < 3; ++k) {
                moves.col(k) = Vec3::Unit(k);
                moves.col(k + 3) = Vec3::Unit(k).cross(arm);
            }
            const Mat3 along = n * n.transpose();
            const Mat3 contact = kn * along + ks * (Mat3::Identity() - along);
            sum += 2 * moves.transpose() * contact * moves;
        }
        const Mat6 scaled = root.asDiagonal() * sum * root.asDiagonal();
        largest =
            std::max(largest, Eigen::SelfAdjointEigenSolver<Mat6>(scaled).eigenvalues().maxCoeff());
    }
    return 0.999 * 2 / std::sqrt(largest);
}

} // namespace

TEST_SUITE("contact/stable_step") {
    TEST_CASE("the estimate for many spheres is the least step of any of them") {
        for (const double ratio : {0.0, 2.0 / 7, 1.0})
            for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
                CAPTURE(ratio);
                CAPTURE(seed);
                World world = make_world(Grains::spheres);
                const auto material = add_material(world, linear_material(kn, ratio * kn, 1));
                std::vector<Vec3> places; // a lattice with gaps, in which some touch
                for (std::uint64_t k = 0; k < 216; ++k) {
                    Random random(seed, k);
                    if (random.uniform() < 0.3) continue;
                    const Vec3 site(static_cast<double>(k % 6), static_cast<double>(k / 6 % 6),
                                    static_cast<double>(k / 36));
                    places.push_back(radius * (1.99 * site + 0.02 * random.direction()));
                    add_sphere(world, places.back(), radius, material);
                }
                const double mass = value_of<Mass>(world, 0),
                             inertia = value_of<SphereInertia>(world, 0);
                Simulation sim = begin(std::move(world), {});
                const double least = least_step_of_all(places, ratio * kn, mass, inertia),
                             found = estimate(sim);
                CHECK(found <= least * (1 + 1e-9));
                CHECK(found >= least * (1 - 5e-4));
            }
    }

    TEST_CASE("the estimate for a sphere on a wall is its stability limit") {
        for (const double ratio : {0.0, 2.0 / 7, 0.5, 1.0}) {
            CAPTURE(ratio);
            Simulation sim = on_floor(ratio * kn, 1e-12);
            const double mass = value_of<Mass>(sim, 1), step = estimate(sim);
            // 2 sqrt(m/kn) for the normal direction; about 1.0690 sqrt(m/ks) for rolling, with the
            // lever arm to the middle of the overlap
            const double arm = radius - 0.5 * 1.001 * mass * 1000 / kn;
            const double rolling =
                ratio * kn * (1 / mass + arm * arm / value_of<SphereInertia>(sim, 1));
            const double limit =
                std::min(2 * std::sqrt(mass / kn), ratio > 0 ? 2 / std::sqrt(rolling) : 1.0);
            CHECK(step <= limit);
            // a margin of 1e-3, and an eigenvalue at most 0.05 % too large
            CHECK(step >= 0.998 * limit);
            if (ratio > 0) continue;
            Simulation at_estimate = on_floor(0, step), below = on_floor(0, 0.99 * limit),
                       above = on_floor(0, 1.01 * limit);
            CHECK(stays_small(at_estimate, 1, step));
            CHECK(stays_small(below, 1, 0.99 * limit));
            CHECK_FALSE(stays_small(above, 1, 1.01 * limit));
        }
    }

    TEST_CASE("a sphere on a wall with an undamped tangential spring is stable at the estimate") {
        Simulation sim = on_floor(kn, 1e-12);
        const double step = estimate(sim);
        Simulation at_estimate = on_floor(kn, step);
        CHECK(stays_small(at_estimate, 1, step));
    }

    TEST_CASE(
        "the estimate for a free pair is its stability limit, for soft and stiff shear springs") {
        for (const double ratio : {0.0, 0.1, 2.0 / 7, 0.5, 0.8, 1.0}) {
            CAPTURE(ratio);
            CHECK(pair_estimate(ratio) <= 1 + 1e-4); // for the lever arm, shortened by the overlap
            CHECK(pair_estimate(ratio) >= 0.998);
        }
    }

    TEST_CASE("the estimate for a clump includes all of its contacts and its rotation") {
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, linear_material(kn, 0, 0));
        add_floor(world, material);
        std::vector<Ball> feet;
        for (const double x : {-1.0, 1.0})
            for (const double y : {-1.0, 1.0})
                feet.push_back({Vec3(0.02 * x, 0.015 * y, 0), radius});
        const Clump block = make_clump("block", feet);
        const EntityId body =
            add_clump(world, block, 0, Vec3::Zero(), Quat(Quat::Identity()), material);
        const double mass = value_of<Mass>(world, body);
        value_of<Position>(world, body) = Vec3(0, 0, radius - mass * 1000 / (4 * kn));
        set_angular_velocity(world, body, Vec3(1e-3, 1e-3, 0));
        world.add_resource<Gravity>({Vec3(0, 0, -1000)});
        const Vec3 inertia = value_of<Inertia>(world, body);
        Simulation sim = begin(std::move(world), {});
        const double step = estimate(sim);
        // modes of four springs: heave 4k/m, pitch 4 k x^2 / I_y, roll 4 k y^2 / I_x
        const double largest =
            std::max({4 * kn / mass, 4 * kn * 4e-4 / inertia.y(), 4 * kn * 2.25e-4 / inertia.x()});
        const double limit = 2 / std::sqrt(largest);
        MESSAGE("clump on four feet: the estimate is ", step / limit, " of the limit");
        CHECK(step <= limit);
        CHECK(step >= 0.998 * limit);
        CHECK(stays_small(sim, body, step));
    }

    TEST_CASE(
        "before anything touches, the bound for first contacts does not exceed the limit of any "
        "single contact") {
        for (const double ratio : {0.0, 0.1, 2.0 / 7}) {
            CAPTURE(ratio);
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(kn, ratio * kn, 1));
            const EntityId a = add_sphere(world, Vec3::Zero(), radius, material);
            const double mass = value_of<Mass>(world, a);
            Simulation sim = begin(std::move(world), {});
            CHECK(std::isinf(stable_step(sim.world())));
            const double limit =
                std::min(std::sqrt(2 * mass / kn),
                         ratio > 0 ? 2 / std::sqrt(7.0) * std::sqrt(mass / (ratio * kn)) : 1.0);
            CHECK(stable_step_of_first_contact(sim.world()) <= limit * (1 + 1e-9));
            CHECK(stable_step_of_first_contact(sim.world()) >= 0.4 * limit);
        }
    }

    TEST_CASE("the stiffness of a body is the sum over its contacts, for rotation with the squares "
              "of their lever arms") {
        for (const double ks : {0.0, 0.3 * kn}) {
            CAPTURE(ks);
            World world = make_world(Grains::clumps);
            const auto material = add_material(world, linear_material(kn, ks, 1));
            add_floor(world, material);
            const std::vector<Ball> feet{{Vec3(-0.03, 0, 0), radius}, {Vec3(0.03, 0, 0), radius}};
            const EntityId body = add_clump(world, make_clump("feet", feet), 0,
                                            Vec3(0, 0, radius - 1e-7), Quat::Identity(), material);
            Simulation sim = begin(std::move(world), {.dt = 1e-12});
            sim.advance();
            const BodyStiffness found = body_stiffness(sim.world())[row_of_body(sim.world(), body)];
            const double along = 0.03 * 0.03, down = radius * radius;
            CHECK(found.translation == about(2 * kn).epsilon(1e-9));
            CHECK(found.rotation ==
                  about(2 * kn * along + 2 * ks * (along + down)).epsilon(1e-4)); // the overlap
        }
    }
}
