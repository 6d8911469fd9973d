#include "engine/assets.hpp"
#include "engine/parallel.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "systems/fields/solid_fraction.hpp"
#include "systems/output/porosity.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

World world_of(const std::vector<Ball>& balls) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, {"rock", 2650, 1e6});
    for (const Ball& ball : balls) add_sphere(world, ball.centre, ball.radius, material);
    return world;
}

/// Volume of the rocks of a world, voxel by voxel.
MeasuredVolume volume_of(const World& world, double voxel, int samples) {
    SolidFraction field(Lattice{Vec3::Constant(0.5 * voxel), voxel}, samples);
    field.update(world);
    return field.volume();
}

/// Rocks of 30 spheres in random poses.
World rocks(unsigned count, std::uint64_t seed) {
    const auto clumps = read_clumps(assets_folder() / "clumps");
    World world = make_world(Grains::clumps);
    const auto material = add_material(world, {"rock", 2650, 1e6});
    for (unsigned k = 0; k < count; ++k) {
        Random random(seed, k);
        const Vec3 x(random.uniform(0, 0.2), random.uniform(0, 0.2), random.uniform(0, 0.2));
        const Clump rock = scaled(clumps[k % clumps.size()], 0.035 / clumps[0].sieve);
        add_clump(world, rock, 0, x, random.rotation(), material);
    }
    return world;
}

bool same_fields(const SolidFraction& a, const SolidFraction& b) {
    if (!(a.blocks() == b.blocks())) return false;
    for (std::uint32_t n = 0; n < a.blocks().voxels(); ++n)
        if (a.solid()[n] != b.solid()[n] || a.error()[n] != b.error()[n]) return false;
    return true;
}

} // namespace

TEST_SUITE("fields/solid_fraction") {
    TEST_CASE("the volume of one sphere is exact to 1e-4") {
        const double r = 0.02;
        const World world = world_of({{Vec3(0.0013, -0.0021, 0.0007), r}});
        const double exact = 4 * pi / 3 * r * r * r;
        const MeasuredVolume found = volume_of(world, 2e-3, 8);
        CHECK(found.value == doctest::Approx(exact).epsilon(1e-4));
        CHECK(std::abs(found.value - exact) < 4 * found.error + 1e-6 * exact);
    }

    TEST_CASE("the overlap of two spheres counts once: the lens of the closed form") {
        const double a = 0.02, b = 0.015, d = 0.022;
        const World world = world_of({{Vec3(0.001, 0.002, 0.003), a},
                                      {Vec3(0.001, 0.002, 0.003) + d * Vec3(1, 2, 2) / 3, b}});
        // volume of the lens of two spheres at the distance d
        const double lens = pi * (a + b - d) * (a + b - d) *
                            (d * d + 2 * d * (a + b) - 3 * (a - b) * (a - b)) / (12 * d);
        const double exact = 4 * pi / 3 * (a * a * a + b * b * b) - lens;
        CHECK(volume_of(world, 2e-3, 8).value == doctest::Approx(exact).epsilon(1e-4));
    }

    TEST_CASE("the volume of a clump of 30 spheres is that of the clump library") {
        const auto clumps = read_clumps(assets_folder() / "clumps");
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, {"rock", 2650, 1e6});
        Random random(3, 1);
        const Clump rock = scaled(clumps[2], 0.04 / clumps[2].sieve);
        add_clump(world, rock, 0, Vec3(0.01, 0.02, 0.03), random.rotation(), material);
        // an independent quadrature, to 1e-6
        const double exact = union_properties(rock.balls, 1e-6).volume;
        CHECK(rock.volume == doctest::Approx(exact).epsilon(1e-4));
        CHECK(volume_of(world, 2e-3, 8).value == doctest::Approx(exact).epsilon(1e-4));
    }

    TEST_CASE("the fraction of single voxels is that of the plane that cuts them") {
        // a sphere so large that its surface is a plane within a voxel: sagitta 1.25e-7 of a voxel
        const double r = 1000, h = 0.01;
        const World world = world_of({{Vec3(0.005, 0.005, -r + 0.0337), r}});
        const Lattice lattice{Vec3::Constant(0.5 * h), h};
        BodySpheres bodies = spheres_of_bodies(world);
        bodies.box[0] = {Vec3(0.001, 0.001, 0.001), Vec3(0.009, 0.009, 0.079)};
        SolidFraction field(lattice, 2);
        field.update(bodies);
        const auto at = [&](int z) { return field.solid()[field.blocks().number({0, 0, z})]; };
        CHECK(at(2) == doctest::Approx(1));
        CHECK(at(3) == doctest::Approx(0.37).epsilon(1e-5));
        CHECK(at(4) == 0);
    }

    TEST_CASE("halving the voxels reduces the error of a sphere, and the estimate bounds it") {
        const double r = 0.02, exact = 4 * pi / 3 * r * r * r;
        double coarse = 0, fine = 0;
        for (unsigned k = 0; k < 20; ++k) {
            Random random(11, k);
            const World world = world_of({{0.01 * random.direction(), r}});
            const MeasuredVolume a = volume_of(world, 4e-3, 2), b = volume_of(world, 1e-3, 2);
            coarse += std::abs(a.value - exact) / exact / 20;
            fine += std::abs(b.value - exact) / exact / 20;
            CHECK(std::abs(a.value - exact) < 10 * a.error + 1e-3 * exact);
        }
        CHECK(coarse < 5e-3);
        CHECK(fine < coarse / 4); // order 1.5: a factor of 8
    }

    TEST_CASE("a field has the same bits for any number of threads and order of rows") {
        const World world = rocks(60, 5);
        const Lattice lattice{Vec3::Constant(2.5e-3), 5e-3};
        std::vector<SolidFraction> fields;
        for (const unsigned count : {1u, 2u, 3u}) {
            fields.emplace_back(lattice, 3);
            Threads(count).run([&] { fields.back().update(world); });
        }
        World turned = world;
        std::vector<Row> order(60);
        for (Row k = 0; k < 60; ++k) order[k] = 59 - k;
        turned.table<Bodies>().keep(order);
        fields.emplace_back(lattice, 3);
        fields.back().update(turned);
        for (const SolidFraction& field : fields) CHECK(same_fields(field, fields[0]));
    }

    TEST_CASE("only what has moved is computed again, with the bits of a new field") {
        World world = rocks(60, 6);
        const Lattice lattice{Vec3::Constant(2.5e-3), 5e-3};
        SolidFraction kept(lattice, 3);
        kept.update(world);
        CHECK(kept.computed_columns() == kept.columns());
        kept.update(world);
        CHECK(kept.computed_columns() == 0);
        for (unsigned k = 0; k < 5; ++k) {
            // a rock in the middle, so that the blocks remain
            const auto x = world.column<Bodies, Position>();
            Row inner = 0;
            for (Row r = 0; r < x.size(); ++r)
                if ((x[r] - Vec3::Constant(0.1)).norm() < (x[inner] - Vec3::Constant(0.1)).norm())
                    inner = r;
            x[inner] += 2e-3 * Random(7, k).direction();
            kept.update(world);
            CHECK(kept.computed_columns() < kept.columns());
            SolidFraction made_anew(lattice, 3);
            made_anew.update(world);
            CHECK(same_fields(kept, made_anew));
        }
    }

    TEST_CASE("the porosity of a specimen in a membrane is within 0.001 of the exact one") {
        World world = rocks(60, 8); // some overlap, as in the union
        const double radius = 0.2, height = 0.2;
        for (Vec3& x : world.column<Bodies, Position>()) x -= Vec3(0.1, 0.1, 0);
        const auto wall = add_material(world, {"wall", 0, 1e6});
        add_tube(world, {.rings = 4, .sectors = 12, .radius = radius, .height = height}, wall);
        const Container container(world, {Vec3::Constant(-1), Vec3::Constant(1)});
        const Box3 box = container.bounds();
        const double h = 5e-3;
        SolidFraction field(Lattice{Vec3::Constant(0.5 * h), h}, 3);
        field.update(world, &container, &box);
        // exact: polygon times height, and the union on lines ten times as dense
        const double all = 12 * std::tan(pi / 12) * radius * radius * height;
        Simulation s = begin(std::move(world), {}); // finds the spheres of each body
        forget_lists(s.world());
        const double solid = solid_volume(s.world(), {0.3, 0, height}, 1200);
        const double voids = h * h * h * field.voids().sum();
        CHECK(std::abs(voids / all - (1 - solid / all)) < 1e-3);
    }

    TEST_CASE("a blocked box holds no voids, and the voids above and below it remain") {
        const World world = world_of({{Vec3(0.5, 0.5, 0.5), 0.02}}); // a rock outside
        const double h = 5e-3;
        const Box3 all{Vec3::Zero(), Vec3(0.1, 0.1, 0.2)},
            blocked{Vec3(0.05, -1, 0.0625), Vec3(1, 1, 0.15)};
        SolidFraction field(Lattice{Vec3::Constant(0.5 * h), h}, 4);
        const Container container(world, all, {blocked});
        field.update(world, &container, &all);
        const double voids = h * h * h * field.voids().sum();
        CHECK(std::abs(voids - (0.1 * 0.1 * 0.2 - 0.05 * 0.1 * 0.0875)) < 1e-12);
        CHECK_FALSE(container == Container(world, all));
    }
}
