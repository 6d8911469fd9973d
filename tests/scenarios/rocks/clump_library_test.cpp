#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/fit_spheres.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/rocks/surface_distance.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using namespace bris;

TEST_SUITE("rocks/clump_library") {
    TEST_CASE("the library has ten rocks of thirty balls and a cube, all of sieve size one") {
        const std::vector<Clump> clumps = read_clumps(assets_folder() / "clumps");
        REQUIRE(clumps.size() == 11);
        CHECK(clumps[0].name == "cube");
        CHECK(clumps[10].name == "rock_10");
        for (const Clump& clump : clumps) {
            CHECK(clump.balls.size() == 30);
            CHECK(clump.sieve == 1);
            const double ratio = compute_dimensions(clump.balls).flat_elongated();
            CHECK(ratio >= 0.99);
            CHECK(ratio < 2.9);
            for (const Ball& ball : clump.balls) CHECK(ball.radius > 0.11);
        }
        // the principal moments of a cube are equal, and its axes are those of its faces
        CHECK(clumps[0].inertia.maxCoeff() == about(clumps[0].inertia.minCoeff()).epsilon(1e-4));
        CHECK(std::abs(clumps[0].balls[0].centre.x()) ==
              about(std::abs(clumps[0].balls[0].centre.y())).epsilon(1e-3));
    }

    TEST_CASE("a written clump is read back bit for bit, and a wrong stored value is detected") {
        const Clump made =
            make_clump("pair", std::vector<Ball>{{Vec3(0, 0, 0), 0.5}, {Vec3(0.4, 0, 0), 0.4}});
        const TemporaryDirectory folder;
        const auto path = folder / "pair.csv";
        write_clump(path, made, {"SOURCE: a test"});
        const Clump read = read_clump(path);
        CHECK(read.volume == made.volume);
        CHECK(read.inertia == made.inertia);
        CHECK(read.balls[1].centre == made.balls[1].centre);
        CHECK(read.bounding_radius == made.bounding_radius);

        std::ostringstream text;
        text << std::ifstream(path).rdbuf();
        const auto twice = folder / "twice.csv";
        const std::string whole = text.str();
        std::ofstream(twice) << whole << whole.substr(whole.rfind('\n', whole.size() - 2) + 1);
        CHECK_THROWS_WITH_AS(read_clump(twice), doctest::Contains("expected each sphere once"),
                             InputError);
        std::ofstream(twice) << whole << "1e300,0,0,1\n";
        CHECK_THROWS_WITH_AS(read_clump(twice), doctest::Contains("radius of at most 100 m"),
                             InputError);
        std::ofstream(twice) << "\xef\xbb\xbf" << whole; // as an editor may save it
        CHECK(read_clump(twice).volume == made.volume);
        for (const char* name : {"volume = ", "inertia_y = ", "sieve = "}) {
            std::string wrong = text.str();
            wrong.insert(wrong.find(name) + std::string(name).size(), 1, '1');
            const auto bad = folder / "wrong.csv";
            std::ofstream(bad) << wrong;
            CHECK_THROWS_WITH_AS(read_clump(bad), doctest::Contains("wrong.csv:"), InputError);
        }
    }

    TEST_CASE("an empty directory is refused") {
        const TemporaryDirectory empty;
        CHECK_THROWS_AS(read_clumps(empty.path()), InputError);
    }
}

TEST_SUITE("rocks/fit_spheres") {
    TEST_CASE("fitted spheres have the volume and moments of the solid and lie close to its "
              "surface") {
        const Polyhedron rock = make_rock({.flat_elongated = 1.6, .faces = 12}, 4, 1);
        std::vector<Ball> balls = fit_spheres(rock, 1.0, {.rounds = 15}, 1);
        match_moments(rock, balls);
        const MassProperties wanted = mass_properties(rock), found = union_properties(balls, 400);
        CHECK(balls.size() == 30);
        CHECK(found.volume == about(wanted.volume).epsilon(1e-3));
        CHECK((found.centre - wanted.centre).norm() < 2e-3);
        CHECK((found.inertia - wanted.inertia).norm() < 0.02 * wanted.inertia.norm());
        CHECK(distance_to_union(rock, balls).mean < 0.02);
        for (const Ball& ball : balls) CHECK(ball.radius > 0.11);
    }
}
