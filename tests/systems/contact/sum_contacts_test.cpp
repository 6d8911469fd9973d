#include "components/force_sums.hpp"
#include "engine/errors.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

/// Sum of the contact forces on all bodies, in units of the grid.
std::array<std::int64_t, 3> sum_of_forces(const World& world) {
    const double unit = world.resource<ForceGrid>().force;
    std::array<std::int64_t, 3> sum{};
    for (const Vec3& force : world.column<Bodies, Force>())
        for (int i = 0; i < 3; ++i) {
            const double units = force[i] / unit;
            REQUIRE(std::abs(units) < 0x1p53); // so that the conversion to N was exact
            REQUIRE(units == std::round(units));
            sum[static_cast<std::size_t>(i)] += static_cast<std::int64_t>(units);
        }
    return sum;
}

} // namespace

TEST_SUITE("contact/sum_contacts") {
    TEST_CASE("the contact forces on all bodies and boundaries cancel exactly") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const Walls walls : {Walls::planes, Walls::facets}) {
                World world = bed({.grains = grains, .walls = walls, .bodies = 60, .seed = 5});
                world.resource<Gravity>().value = Vec3::Zero();
                for (Vec3& v : world.column<Bodies, Velocity>()) v = Vec3::Zero();
                const auto velocity = world.column<Bodies, Velocity>();
                const auto motion = world.column<Bodies, MotionOf>();
                for (Row b = 0; b < velocity.size(); ++b)
                    if (motion[b] == static_cast<std::uint32_t>(Motion::free))
                        velocity[b] = 0.5 * Random(9, b).direction();
                Simulation sim =
                    begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
                std::size_t contacts = 0;
                for (int k = 0; k < 40; ++k) {
                    sim.advance(25);
                    contacts += compute_quantities(sim.world()).contacts;
                    CHECK(sum_of_forces(sim.world()) == std::array<std::int64_t, 3>{});
                }
                CHECK(contacts > 20);
            }
    }

    TEST_CASE(
        "the momentum of colliding grains without boundaries stays constant to the round-off of "
        "their own updates") {
        constexpr EntityId count = 64;
        constexpr double radius = 0.01;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
        for (EntityId k = 0; k < count; ++k) {
            const Vec3 x = 2.3 * radius * Vec3(k % 4, k / 4 % 4, k / 16);
            add_sphere(world, x, radius * Random(3, k).uniform(0.7, 1), material);
            // towards the middle, and to one side
            value_of<Velocity>(world, k) =
                10 * (Vec3::Constant(3.45 * radius) - x) + Vec3(0.3, 0, 0);
        }
        Simulation sim = begin(std::move(world), {.dt = 1e-5, .law = LawName::linear});
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            double size = 0;
            for (EntityId k = 0; k < count; ++k) {
                const Vec3 one = value_of<Mass>(sim, k) * value_of<Velocity>(sim, k);
                sum += one;
                size += one.norm();
            }
            return std::pair(sum, size);
        };
        sim.advance();
        const auto [before, size] = momentum();
        std::size_t contacts = 0;
        for (int k = 0; k < 20; ++k) {
            sim.advance(200);
            contacts += compute_quantities(sim.world()).contacts;
        }
        REQUIRE(contacts > 50);
        // 4000 updates of each velocity, each rounded to 2^-53
        CHECK((momentum().first - before).norm() < 4000 * 0x1p-53 * size);
    }

    TEST_CASE("rough grains without boundaries keep their angular momentum, also across the chunks "
              "in which contacts are computed") {
        constexpr EntityId count = 512;
        constexpr double radius = 0.01;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
        for (EntityId k = 0; k < count; ++k) {
            const Vec3 x = 2.05 * radius * Vec3(k % 8, k / 8 % 8, k / 64);
            add_sphere(world, x, radius * Random(3, k).uniform(0.9, 1), material);
            value_of<Velocity>(world, k) = 15 * (Vec3::Constant(7.2 * radius) - x);
            set_angular_velocity(world, k, 50 * Random(4, k).direction());
        }
        Simulation sim =
            begin(std::move(world), {.dt = 1e-5, .law = LawName::linear, .threads = 2});
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            double size = 0;
            for (EntityId k = 0; k < count; ++k) {
                const Vec3 orbit = value_of<Position>(sim, k).cross(value_of<Mass>(sim, k) *
                                                                    value_of<Velocity>(sim, k)),
                           spin = value_of<AngularMomentum>(sim, k);
                sum += orbit + spin;
                size += orbit.norm() + spin.norm();
            }
            return std::pair(sum, size);
        };
        sim.advance();
        const auto [before, size] = momentum();
        std::size_t contacts = 0, chunks = 0;
        for (int k = 0; k < 20; ++k) {
            sim.advance(50);
            contacts += compute_quantities(sim.world()).contacts;
            chunks = std::max(chunks, sim.world().resource<NearIndex<SpherePairs>>().chunks.size());
        }
        REQUIRE(contacts > 1000);
        REQUIRE(chunks > 1);
        CHECK((momentum().first - before).norm() < 1000 * 0x1p-53 * size);
    }

    TEST_CASE("a sphere on a floor exerts its force on the floor at the point of contact") {
        constexpr double radius = 0.01, overlap = 1e-5, kn = 1e5;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(kn));
        const EntityId floor = add_floor(world, material);
        add_sphere(world, Vec3(0.3, -0.2, radius - overlap), radius, material);
        Simulation sim = begin(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
        sim.advance();
        const Vec3 force = value_of<Force>(sim, floor), torque = value_of<Torque>(sim, floor);
        CHECK(force.z() == about(-kn * overlap).epsilon(1e-9));
        CHECK((torque - Vec3(0.3, -0.2, 0).cross(force)).norm() < 1e-9 * force.norm());
        CHECK(torque.norm() > 0.3 * force.norm());
    }

    TEST_CASE("the units resolve the force of a contact at the limit of overlap to 2^-54, whatever "
              "the material and size") {
        for (const double stiffness : {1e2, 1e5, 1e9})
            for (const double radius : {1e-4, 0.02, 3.0}) {
                World world = make_world(Grains::spheres);
                const auto material = add_material(world, linear_material(stiffness));
                add_sphere(world, Vec3(0, 0, 0), radius, material);
                add_sphere(world, Vec3(0, 0, 1.9 * radius), radius, material);
                Simulation sim =
                    begin(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
                sim.advance();
                const double force = value_of<Force>(sim, 1).z();
                CHECK(force == about(stiffness * 0.1 * radius).epsilon(1e-12));
                const double limit = stiffness * Limits{}.overlap * radius,
                             unit = sim.world().resource<ForceGrid>().force;
                CHECK(unit <= limit * 0x1p-54);
                CHECK(unit > limit * 0x1p-56);
            }
    }

    TEST_CASE("a rigid boundary does not make the units coarser than those of real contacts") {
        const auto unit = [](double stiffness_of_wall) {
            World world = make_world(Grains::spheres);
            const auto grain = add_material(world, linear_material(1e5)),
                       wall = add_material(world, linear_material(stiffness_of_wall));
            add_sphere(world, Vec3(0, 0, 0.02), 0.01, grain);
            add_floor(world, wall);
            Simulation sim = begin(std::move(world), {.law = LawName::linear_frictionless});
            sim.advance();
            return sim.world().resource<ForceGrid>().force;
        };
        CHECK(unit(1e30) <= 2 * unit(1e5));
    }

    TEST_CASE("a contact force beyond the range of the sums stops the run with the bodies' ids") {
        World world = make_world(Grains::spheres);
        Material m = linear_material(1e5);
        m.restitution = 0.1;
        const auto material = add_material(world, m);
        add_sphere(world, Vec3(0, 0, 0), 0.01, material);
        add_sphere(world, Vec3(0, 0, 0.0199999), 0.01, material);
        value_of<Velocity>(world, 1) = Vec3(0, 0, -1e5);
        Simulation sim = begin(std::move(world),
                               {.dt = 1e-13, .law = LawName::linear_viscous, .unlimited = true});
        CHECK_THROWS_WITH_AS(sim.advance(10),
                             doctest::Contains("contact force of bodies 0 and 1: expected a number "
                                               "up to"),
                             SimulationError);
    }
}
