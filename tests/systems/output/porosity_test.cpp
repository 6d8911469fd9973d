#include "scenarios/specimens/scene.hpp"
#include "systems/output/porosity.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("output/porosity") {
    TEST_CASE("the porosity of a box with two overlapping spheres, one of them cut, is exact") {
        constexpr double r = 0.01, apart = 0.012;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e6, 0, 0));
        (void)add_sphere(world, Vec3(0, 0, 0), r, material);
        (void)add_sphere(world, Vec3(apart, 0, 0), r, material);
        (void)add_sphere(world, Vec3(0, 0, 0.1), r, material); // outside
        Simulation s = begin(std::move(world), {.dt = 1e-12, .unlimited = true});
        s.advance(); // finds the spheres of each body
        // a lens of two caps of height r - apart / 2 counts once; the box ends at x = apart
        const double ball = 4 * pi / 3 * r * r * r, cap = r - apart / 2,
                     lens = 2 * pi * cap * cap * (3 * r - cap) / 3, solid = 1.5 * ball - lens;
        const Vec3 low(-0.02, -0.015, -0.02), high(apart, 0.015, 0.03);
        const double part = porosity(s.world(), BoxRegion{low, high}, 1e-4);
        CHECK(part == about(1 - solid / (high - low).prod()).epsilon(1e-4));
        CHECK(porosity(s.world(), BoxRegion{Vec3(0.05, 0, 0), Vec3(0.06, 0.01, 0.01)}, 1e-3) == 1);
    }
}
