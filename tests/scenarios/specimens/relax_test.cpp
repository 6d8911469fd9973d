#include "scenarios/specimens/relax.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// Spheres of 1 cm radius on a lattice with overlaps of `overlap` of the diameter, in a box of half
/// side `room` (m).
World squeezed(double overlap, double room) {
    World world = make_world(Grains::spheres);
    Material m = linear_material(1e5, 5e4, 0.5);
    m.young_modulus = 1e8;
    m.poisson_ratio = 0.25;
    const auto grain = add_material(world, m);
    const double pitch = 0.02 * (1 - overlap);
    for (int k = 0; k < 27; ++k)
        add_sphere(world, pitch * Vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1), 0.01, grain);
    add_box(world, -room * Vec3::Ones(), room * Vec3::Ones(), grain);
    world.add_resource<Gravity>();
    return world;
}

} // namespace

TEST_SUITE("specimens/relax") {
    TEST_CASE("an overlapping lattice relaxes to small overlaps, and its kinetic energy never "
              "exceeds the elastic energy of the start") {
        for (const LawName law : {LawName::linear, LawName::hertz_mindlin})
            for (const double overlap : {0.3, 0.9}) {
                CAPTURE(overlap);
                World world = squeezed(overlap, 0.06);
                const Relaxed r = relax(world, law);
                CHECK_MESSAGE(r.done, r.left);
                CHECK(r.first_overlap == about(overlap).epsilon(1e-9));
                CHECK(r.overlap <= 0.01);
                CHECK(r.speed <= r.speed_limit);
                CHECK(r.stored_energy > 0);
                CHECK(r.peak_energy <= r.stored_energy);
                // the scene is at rest in the new positions, with its own gravity and limits
                CHECK(value_of<Velocity>(world, 13).norm() == 0);
                CHECK(world.resource<Gravity>().value.z() == -9.81);
                CHECK(world.resource<Limits>().overlap == 0.25);
                double least = 1;
                for (EntityId a = 0; a < 27; ++a)
                    for (EntityId b = 0; b < a; ++b)
                        least = std::min(
                            least,
                            (value_of<Position>(world, a) - value_of<Position>(world, b)).norm());
                CHECK(least >= 0.02 * (1 - 0.01) - 1e-12);
            }
    }

    TEST_CASE("without enough room the relaxation reports the remaining overlap") {
        World world = squeezed(0.3, 0.021); // 27 spheres of 2 cm in a box of 4.2 cm
        const Relaxed r = relax(world, LawName::linear, {.longest = 5000});
        CHECK_FALSE(r.done);
        CHECK(r.steps == 5000);
        CAPTURE(r.left);
        CHECK(r.left.find("still overlap") != std::string::npos);
    }

    TEST_CASE("a start without overlaps is not changed") {
        World world = squeezed(-0.2, 0.06);
        const Vec3 before = value_of<Position>(world, 5);
        const Relaxed r = relax(world, LawName::linear);
        CHECK(r.done);
        CHECK(r.steps == 0);
        CHECK((value_of<Position>(world, 5) - before).norm() == 0);
    }
}
