#include "engine/assets.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/rocks/refill_clump.hpp"
#include "scenarios/rocks/surface_distance.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

TEST_SUITE("rocks/refill_clump") {
    TEST_CASE("the surface of a clump of one sphere is a closed polyhedron inscribed in it") {
        Clump ball{.name = "ball",
                   .balls = {{Vec3(0.1, 0, 0), 1}},
                   .volume = 4 * pi / 3,
                   .inertia = Vec3::Ones(),
                   .bounding_radius = 1.1,
                   .sieve = 2};
        const Polyhedron solid = surface_of(ball);
        for (const Vec3& vertex : solid.vertices)
            CHECK((vertex - ball.balls[0].centre).norm() == about(1).epsilon(1e-12));
        const double volume =
            mass_properties(solid).volume; // correct only if the surface is closed and outwards
        CHECK(volume < ball.volume);
        CHECK(volume > (1 - 3 * (1 - std::cos(pi / 12))) *
                           ball.volume); // edges of 15 degrees lie inside by at most 1 - cos(7.5),
                                         // faces by twice that
    }

    TEST_CASE("a rock modelled by fewer spheres keeps volume, centre of mass, mass and inertia, "
              "and approximately the surface") {
        const Clump rock = scaled(read_clump(assets_folder() / "clumps" / "rock_05.csv"), 0.03);
        const Clump eight = refilled(rock, 8, 1), again = refilled(rock, 8, 1);
        REQUIRE(eight.balls.size() == 8);
        const MassProperties found = union_properties(eight.balls);
        CHECK(found.volume == about(rock.volume).epsilon(1e-4));
        CHECK(found.centre.norm() < 1e-4 * rock.sieve);
        for (int k = 0; k < 3; ++k)
            CHECK(found.inertia(k, k) == about(rock.inertia[k]).epsilon(0.06)); // corners are cut
        CHECK(eight.volume == rock.volume);
        CHECK(eight.inertia == rock.inertia);
        CHECK(eight.sieve == rock.sieve);
        CHECK(eight.name == rock.name);
        CHECK(eight.bounding_radius < 1.05 * rock.bounding_radius);
        CHECK(distance_to_union(surface_of(rock), eight.balls).mean < 0.04 * rock.sieve);
        for (std::size_t k = 0; k < 8; ++k) {
            CHECK(again.balls[k].centre == eight.balls[k].centre);
            CHECK(again.balls[k].radius == eight.balls[k].radius);
        }
    }
}
