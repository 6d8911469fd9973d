#include "engine/ordering.hpp"
#include "systems/fields/coarse_grain.hpp"
#include "systems/fields/smooth.hpp"
#include "systems/fields/solid_fraction.hpp"
#include "systems/output/stress.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

VoxelBlocks blocks_of(const World& world, double voxel) {
    SolidFraction solid(Lattice{Vec3::Constant(0.5 * voxel), voxel}, 2);
    solid.update(world);
    return solid.blocks();
}

} // namespace

TEST_SUITE("fields/coarse_grain") {
    TEST_CASE("smoothing keeps sums and spreads a value as a product of three tents") {
        const Lattice lattice{Vec3::Zero(), 1};
        const Box3 box{Vec3::Constant(0.1), Vec3::Constant(22.9)};
        const VoxelBlocks blocks(lattice, std::span(&box, 1));
        VoxelField field(blocks);
        field[blocks.number({12, 12, 12})] = 1;
        const VoxelField s = smoothed(field, blocks, 2);
        CHECK(s.sum() == doctest::Approx(1));
        CHECK(s[blocks.number({12, 12, 12})] == doctest::Approx(1.0 / 27));
        CHECK(s[blocks.number({13, 12, 10})] == doctest::Approx(2.0 / 9 * 3 / 9 * 1 / 9));
        CHECK(s[blocks.number({12, 15, 12})] == 0);
    }

    TEST_CASE("mass, momentum and the integral of stress are those of the rocks") {
        Simulation s = begin(bed({.grains = Grains::clumps, .bodies = 40, .seed = 4}),
                             {.dt = 2e-5, .law = LawName::linear_viscous});
        s.advance(1500);
        const World& world = s.world();
        const CoarseFields c = coarse_grain(world, blocks_of(world, 5e-3), 2);
        const double volume = c.blocks.lattice().volume();
        double mass = 0;
        Vec3 momentum = Vec3::Zero(), found = Vec3::Zero();
        const auto rows = rows_by_id(world.column<Bodies, BodyId>());
        for (const Row r : rows) {
            const double m = world.column<Bodies, Mass>()[r];
            mass += m;
            momentum += m * (world.column<Bodies, Velocity>()[r] +
                             1e-5 * world.column<Bodies, Acceleration>()[r]);
        }
        CHECK(volume * c.mass_density.sum() == doctest::Approx(mass));
        for (std::uint32_t n = 0; n < c.blocks.voxels(); ++n)
            found += volume * c.mass_density[n] *
                     Vec3(c.velocity[0][n], c.velocity[1][n], c.velocity[2][n]);
        CHECK((found - momentum).norm() < 1e-12 * mass);
        REQUIRE(c.has_stress);
        const Stresses whole = compute_stresses(world);
        CHECK(volume * c.stress[2].sum() == doctest::Approx(whole.contact.axial).epsilon(1e-10));
        CHECK(0.5 * volume * (c.stress[0].sum() + c.stress[1].sum()) ==
              doctest::Approx(whole.contact.radial).epsilon(1e-10));
    }

    TEST_CASE("the velocity gradient of a lattice that moves affinely is found") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, {"rock", 2650, 1e6});
        const double pitch = 0.01;
        Mat3 gradient;
        gradient << -0.3, 0.2, 0, 0.1, 0.05, -0.4, 0.25, 0, 0.1;
        for (int i = 0; i < 10; ++i)
            for (int j = 0; j < 10; ++j)
                for (int k = 0; k < 10; ++k) {
                    const Vec3 x = pitch * (Vec3(i, j, k) + Vec3::Constant(0.5));
                    const EntityId id = add_sphere(world, x, 0.4 * pitch, material);
                    value_of<Velocity>(world, id) = gradient * x;
                }
        // a kernel of two pitches: momentum over mass is exact on the lattice's symmetric voxels
        const CoarseFields c = coarse_grain(world, blocks_of(world, pitch), 1);
        const Mat3 rate = 0.5 * (gradient + gradient.transpose());
        for (int z = 4; z < 6; ++z) {
            const std::uint32_t n = c.blocks.number({5, 4, z});
            const auto e = [&](std::size_t k) { return c.strain_rate[k][n]; };
            CHECK(e(0) == doctest::Approx(rate(0, 0)));
            CHECK(e(1) == doctest::Approx(rate(1, 1)));
            CHECK(e(2) == doctest::Approx(rate(2, 2)));
            CHECK(e(3) == doctest::Approx(rate(0, 1)));
            CHECK(e(4) == doctest::Approx(rate(1, 2)));
            CHECK(e(5) == doctest::Approx(rate(0, 2)));
        }
    }
}
