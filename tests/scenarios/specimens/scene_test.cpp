#include "components/sphere.hpp"
#include "engine/assets.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// The spheres of a body in the world, in the axes of the body.
std::vector<Ball> spheres_of(const World& world, EntityId body) {
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    std::vector<Ball> balls;
    for (std::size_t k = 0; k < parent.size(); ++k)
        if (parent[k] == body) balls.push_back(ball[k]);
    return balls;
}

/// Three spheres of radius 1 m that do not touch each other; their centres are no symmetric
/// triangle.
Clump tripod() {
    const std::vector<Ball> feet{{Vec3(0, 0, 0), 1}, {Vec3(6, 0, 0), 1}, {Vec3(1, 4, 0), 1}};
    return make_clump("tripod", feet);
}

} // namespace

TEST_SUITE("specimens/scene") {
    TEST_CASE("every sphere of a clump is in the world, where the library has it") {
        World world = make_world(Grains::clumps);
        const auto rock = add_material(world, linear_material(1e6));
        const std::vector<Clump> library = read_clumps(assets_folder() / "clumps");
        std::vector<EntityId> bodies;
        for (const Clump& clump : library)
            bodies.push_back(add_clump(world, scaled(clump, 0.04), 0, Vec3(1, 2, 3),
                                       exponential_map(Vec3(0.1, 0.2, 0.3)), rock));
        for (std::size_t k = 0; k < library.size(); ++k) {
            CAPTURE(library[k].name);
            const std::vector<Ball> found = spheres_of(world, bodies[k]);
            REQUIRE(found.size() == library[k].balls.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
                CHECK(found[i].centre == Vec3(0.04 * library[k].balls[i].centre));
                CHECK(found[i].radius == 0.04 * library[k].balls[i].radius);
            }
        }
    }

    TEST_CASE("mass and inertia of a clump in the world are those of the union of its spheres") {
        World world = make_world(Grains::clumps);
        const auto rock = add_material(world, linear_material(1e6, 0, 0, 2700));
        for (const Clump& clump : read_clumps(assets_folder() / "clumps")) {
            CAPTURE(clump.name);
            const EntityId body = add_clump(world, scaled(clump, 0.04), 0, Vec3::Zero(),
                                            Quat(Quat::Identity()), rock);
            const std::vector<Ball> balls = spheres_of(world, body);
            // as accurate as read_clump demands; a missing sphere changes a clump by a few percent
            const MassProperties found = union_properties(balls, 128);
            const Vec3 inertia = value_of<Inertia>(world, body);
            CHECK(found.volume == about(value_of<Mass>(world, body) / 2700).epsilon(1e-3));
            CHECK((2700 * found.inertia.diagonal() - inertia).norm() < 2e-3 * inertia.norm());
            CHECK(found.centre.norm() < 1e-3 * 0.04);
            double reach = 0;
            for (const Ball& b : balls) reach = std::max(reach, b.centre.norm() + b.radius);
            CHECK(reach == about(value_of<BoundingRadius>(world, body)).epsilon(1e-12));
        }
    }

    TEST_CASE("a floor carries a clump on any of its spheres, also on the last") {
        // a jack: six spheres on the axes, so that each in turn is the lowest
        std::vector<Ball> arms;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0})
                arms.push_back({(0.02 + 0.001 * axis) * side * Vec3::Unit(axis), 0.005});
        const Clump jack = make_clump("jack", arms);
        const double kn = 1e5, overlap = 1e-5;
        for (std::size_t k = 0; k < jack.balls.size(); ++k) {
            CAPTURE(k);
            const Ball& lowest = jack.balls[k];
            World world = make_world(Grains::clumps);
            const auto rock = add_material(world, linear_material(kn));
            add_floor(world, rock);
            const double arm = lowest.centre.norm();
            (void)add_clump(world, jack, 0, Vec3(0, 0, arm + lowest.radius - overlap),
                            Quat::FromTwoVectors(lowest.centre, -Vec3::UnitZ()), rock);
            Simulation sim = begin(std::move(world), {.dt = 1e-9});
            sim.advance();
            const auto pairs = touching_pairs<PlanePairs>(sim.world());
            REQUIRE(pairs.size() == 1);
            CHECK(pairs[0].names.sphere == k);
            CHECK(pairs[0].force.normal_force == about(kn * overlap).epsilon(1e-6));
        }
    }

    TEST_CASE("a tripod at rest stands on all three spheres with the forces of statics") {
        World world = make_world(Grains::clumps);
        Material m = linear_material(1e6, 5e5, 0.5);
        m.normal_damping = m.shear_damping = 2000;
        const auto rock = add_material(world, m);
        add_floor(world, rock);
        const Clump stand = scaled(tripod(), 0.01);
        const double g = 9.81;
        const EntityId body =
            add_clump(world, stand, 0, Vec3(0, 0, 0.01), Quat(Quat::Identity()), rock);
        world.add_resource<Gravity>({Vec3(0, 0, -g)});
        Simulation sim = begin(std::move(world), {.dt = 5e-6, .law = LawName::linear_viscous});
        sim.advance(60'000);
        const auto pairs = touching_pairs<PlanePairs>(sim.world());
        REQUIRE(pairs.size() == 3);
        // balance of forces, and of moments about the centre of mass
        Mat3 balance;
        for (int k = 0; k < 3; ++k) {
            const Vec3& foot = stand.balls[static_cast<std::size_t>(k)].centre;
            balance.col(k) << 1, foot.x(), foot.y();
        }
        const Vec3 weight(value_of<Mass>(sim, body) * g, 0, 0),
            expected = balance.inverse() * weight;
        CHECK(value_of<Velocity>(sim, body).norm() < 1e-9);
        for (std::size_t k = 0; k < 3; ++k) {
            CAPTURE(k);
            CHECK(pairs[k].names.sphere == k);
            CHECK(pairs[k].force.normal_force ==
                  about(expected[static_cast<Eigen::Index>(k)]).epsilon(1e-4));
        }
    }
}
