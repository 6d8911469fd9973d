#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// A clump of `balls` equal balls in a row along x, whose centres span a tenth of their radius.
Clump row_of_balls(int balls) {
    std::vector<Ball> list;
    for (int k = 0; k < balls; ++k)
        list.push_back({Vec3(0.1 * (k - 0.5 * (balls - 1)) / std::max(1, balls - 1), 0, 0), 1});
    return make_clump("row", list);
}

struct Rebound {
    double restitution, largest_overlap;
};

/// Drops a clump flat on a plane, or on a fixed clump. Its mass and the stiffness of its material
/// do not depend on the number of balls.
Rebound drop(int balls, PatchStiffness patch, LawName law, bool on_clump) {
    World world = make_world(Grains::clumps);
    Materials& materials = world.resource<Materials>();
    materials.policy.patch = patch;
    const auto grain = add_material(world, {.name = "grain",
                                            .density = 2600,
                                            .normal_stiffness = 2e6,
                                            .restitution = 0.6,
                                            .young_modulus = 1e8,
                                            .poisson_ratio = 0.25});
    Clump clump = scaled(row_of_balls(balls), 0.01);
    const Clump one = scaled(row_of_balls(1), 0.01);
    clump.volume = one.volume; // the same mass
    clump.inertia = one.inertia;
    if (on_clump)
        add_clump(world, clump, 0, Vec3(0, 0, -0.01),
                  Quat(Eigen::AngleAxisd(pi / 2, Vec3::UnitZ())), grain, Motion::fixed);
    else
        add_floor(world, grain);
    const EntityId ball = add_clump(world, clump, 0, Vec3(0, 0, 0.0101), Quat::Identity(), grain);
    value_of<Velocity>(world, ball) = Vec3(0, 0, -0.5);
    Simulation sim = begin(std::move(world), {.dt = 1e-6, .law = law});
    double least = 1;
    for (int k = 0; k < 3000; ++k) {
        sim.advance();
        least = std::min(least, value_of<Position>(sim, ball).z());
    }
    return {value_of<Velocity>(sim, ball).z() / 0.5, 0.01 - least};
}

} // namespace

TEST_SUITE("contact/share_patches") {
    TEST_CASE(
        "if patches share one stiffness, rebound and overlap of a flat drop do not depend on the "
        "number of spheres of a clump") {
        for (const LawName law : {LawName::linear_viscous, LawName::hertz_mindlin_viscous}) {
            const Rebound one = drop(1, PatchStiffness::shared, law, false);
            CHECK(one.restitution == about(0.6).epsilon(5e-3));
            for (const int balls : {2, 8, 30, 100}) {
                CAPTURE(balls);
                const Rebound shared = drop(balls, PatchStiffness::shared, law, false),
                              own = drop(balls, PatchStiffness::per_sphere, law, false);
                // shares are equal, so results differ only by rounding
                CHECK(shared.restitution == about(one.restitution).epsilon(1e-6));
                CHECK(shared.largest_overlap == about(one.largest_overlap).epsilon(1e-6));
                // each sphere has its own stiffness: the overlap falls as 1/sqrt(n) (linear) or
                // n^-0.4 (Hertz)
                const double exponent = law == LawName::linear_viscous ? 0.5 : 0.4;
                CHECK(own.largest_overlap < 1.2 * one.largest_overlap * std::pow(balls, -exponent));
            }
        }
    }

    TEST_CASE("the spheres of two crossed rows share one stiffness") {
        const Rebound one = drop(1, PatchStiffness::shared, LawName::linear_viscous, true);
        const Rebound many = drop(9, PatchStiffness::shared, LawName::linear_viscous, true);
        // the rows cross at one point; spheres beside it overlap more or not at all, so the shares
        // differ slightly
        CHECK(many.restitution == about(one.restitution).epsilon(0.07));
        CHECK(many.largest_overlap == about(one.largest_overlap).epsilon(0.1));
    }

    TEST_CASE("patches on two planes have separate shares: each plane carries a clump as alone") {
        World world = make_world(Grains::clumps);
        world.resource<Materials>().policy.patch = PatchStiffness::shared;
        const auto grain = add_material(world, linear_material(1e5));
        const EntityId host = add_boundary(world, Vec3::Zero(), grain);
        add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
        add_plane(world, host, Vec3::Zero(), Vec3::UnitY());
        const double overlap = 1e-5;
        (void)add_clump(world, scaled(row_of_balls(5), 0.01), 0,
                        Vec3(0, 0.01 - 2 * overlap, 0.01 - overlap), Quat::Identity(), grain);
        Simulation sim = begin(std::move(world), {.dt = 1e-9});
        sim.advance();
        Vec3 force = Vec3::Zero();
        for (const TouchingPair& pair : touching_pairs<PlanePairs>(sim.world())) {
            CHECK(pair.share == about(0.2).epsilon(1e-6));
            force += Vec3(pair.force.fx, pair.force.fy, pair.force.fz);
        }
        CHECK(force.y() == about(2e5 * overlap).epsilon(1e-6));
        CHECK(force.z() == about(1e5 * overlap).epsilon(1e-6));
    }
}
