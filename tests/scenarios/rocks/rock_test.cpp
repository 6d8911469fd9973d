#include "engine/errors.hpp"
#include "scenarios/rocks/angularity.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "scenarios/rocks/rock.hpp"
#include "scenarios/rocks/surface_distance.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace bris;

namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
    static const TemporaryDirectory folder;
    const std::filesystem::path path = folder / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                "f 1 3 2\nf 1 2 4\nf 1 4 3\n";

std::string binary_stl(const Polyhedron& solid) {
    std::string bytes(80, ' ');
    const auto put = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<std::uint32_t>(solid.triangles.size()));
    for (const auto& triangle : solid.triangles) {
        for (int k = 0; k < 3; ++k) put(0.0f);
        for (std::size_t corner : triangle)
            for (int k = 0; k < 3; ++k) put(static_cast<float>(solid.vertices[corner][k]));
        put(std::uint16_t{0});
    }
    return bytes;
}

} // namespace

TEST_SUITE("rocks/rock") {
    TEST_CASE("a cube has its closed-form mass properties, dimensions and sieve size") {
        const Polyhedron cube = make_cube(2);
        const MassProperties mass = mass_properties(cube);
        CHECK(mass.volume == about(8).epsilon(1e-14));
        CHECK(mass.centre.norm() < 1e-14);
        CHECK((mass.inertia - Mat3(Mat3::Identity() * (8 * 4 / 6.0))).norm() < 1e-13); // m a² / 6
        const Dimensions dimensions = compute_dimensions(vertex_balls(cube));
        CHECK(dimensions.flat_elongated() == about(1).epsilon(1e-4));
        CHECK(sieve_size(vertex_balls(cube)) == about(2).epsilon(1e-12));
        CHECK(cube.faces == 6);
    }

    TEST_CASE("a rock has the wanted flat-and-elongated ratio, sieve size one and a closed convex "
              "surface") {
        for (double wanted : {1.2, 1.8, 2.8}) {
            const Polyhedron rock = make_rock({.flat_elongated = wanted, .faces = 14}, 5, 2);
            const std::vector<Ball> hull = vertex_balls(rock);
            // stretched to 1e-3, measured to 1e-4
            CHECK(compute_dimensions(hull).flat_elongated() == about(wanted).epsilon(2e-3));
            CHECK(sieve_size(hull) == about(1).epsilon(5e-4));
            CHECK(rock.vertices.size() + rock.triangles.size() ==
                  rock.triangles.size() * 3 / 2 + 2);
            for (const auto& [i, j, k] : rock.triangles) {
                const Vec3& a = rock.vertices[i];
                const Vec3 normal = (rock.vertices[j] - a).cross(rock.vertices[k] - a).normalized();
                for (const Vec3& vertex : rock.vertices) CHECK(normal.dot(vertex - a) < 1e-6);
            }
        }
    }

    TEST_CASE("the same seed and index give the same rock, another index another rock") {
        const Polyhedron a = make_rock({}, 1, 3), b = make_rock({}, 1, 3), c = make_rock({}, 1, 4);
        REQUIRE(a.vertices.size() == b.vertices.size());
        for (std::size_t k = 0; k < a.vertices.size(); ++k) CHECK(a.vertices[k] == b.vertices[k]);
        CHECK(a.vertices[0] != c.vertices[0]);
    }

    TEST_CASE("settings out of range are refused") {
        CHECK_THROWS_AS(make_rock({.flat_elongated = 0.5}, 1, 0), InputError);
        CHECK_THROWS_AS(make_rock({.faces = 3}, 1, 0), InputError);
    }

    TEST_CASE("angularity is zero for a circle, and increases with fewer faces") {
        Outline circle;
        for (int k = 0; k < 2400; ++k)
            circle.push_back({std::cos(2 * pi * k / 2400), std::sin(2 * pi * k / 2400)});
        CHECK(outline_angularity(circle) == 0);
        double few = 0, many = 0;
        for (std::uint64_t k = 0; k < 6; ++k) {
            const Polyhedron angular = make_rock({.faces = 9}, 2, k),
                             round = make_rock({.faces = 40}, 2, k);
            few += angularity(angular, compute_dimensions(vertex_balls(angular)).axes);
            many += angularity(round, compute_dimensions(vertex_balls(round)).axes);
        }
        CHECK(few > 1.3 * many);
    }

    TEST_CASE("distances to a cube are those of elementary geometry") {
        const Polyhedron cube = make_cube(2);
        CHECK(signed_distance(cube, {0.5, 0, 0}) == about(-0.5));
        CHECK(signed_distance(cube, {3, 0.2, -0.1}) == about(2));
        CHECK(signed_distance(cube, {2, 2, 2}) == about(std::sqrt(3.0)));
        const std::vector<Ball> ball{{Vec3(0, 0, 0), 1.0}}; // touches the faces from inside
        CHECK(distance_to_union(cube, ball).max == about(std::sqrt(3.0) - 1));
    }
}

TEST_SUITE("rocks/read_mesh") {
    TEST_CASE("a tetrahedron from an OBJ file has volume one sixth, even if it is inside out") {
        const auto path = written("tetrahedron.obj", tetrahedron + "f 2 3 4\n");
        CHECK(mass_properties(read_mesh(path)).volume == about(1.0 / 6).epsilon(1e-14));
        const auto turned = written("turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                                  "f 2 3 1\nf 4 2 1\nf 3/1 4//2 -4\nf 4 3 2\n");
        CHECK(mass_properties(read_mesh(turned)).volume == about(1.0 / 6).epsilon(1e-14));
    }

    TEST_CASE("binary and text STL files give the surface that was written") {
        const Polyhedron cube = make_cube(2);
        const Polyhedron back = read_mesh(written("cube.stl", binary_stl(cube)));
        CHECK(back.vertices.size() == 8);
        CHECK(mass_properties(back).volume == about(8).epsilon(1e-12));
        std::string text = "solid cube\n";
        for (const auto& triangle : cube.triangles) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (std::size_t corner : triangle) {
                const Vec3& v = cube.vertices[corner];
                text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " +
                        std::to_string(v.z()) + "\n";
            }
            text += "endloop\nendfacet\n";
        }
        const Polyhedron read = read_mesh(written("text.stl", text + "endsolid\n"));
        CHECK(mass_properties(read).volume == about(8).epsilon(1e-12));
    }

    TEST_CASE("an open surface is refused, and the message names a triangle at the hole") {
        const auto path = written("open.obj", tetrahedron);
        CHECK_THROWS_WITH_AS(read_mesh(path), doctest::Contains(": mesh: expected a closed"),
                             InputError);
    }

    TEST_CASE("a surface in two pieces is refused, and so is a binary STL file that is cut off") {
        for (const double size : {0.2, 3.0}) { // inside, or around and through the first one
            const std::string two =
                tetrahedron + "f 2 3 4\n" +
                fmt::format("v {0} {0} {0}\nv {1} {0} {0}\nv {0} {1} {0}\nv {0} {0} {1}\n"
                            "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n",
                            0.1, size);
            CHECK_THROWS_WITH_AS(read_mesh(written("two.obj", two)),
                                 doctest::Contains("two.obj:13: mesh: expected one closed"),
                                 InputError);
        }
        const auto cut = written("cut.stl", std::string(84, ' ') + std::string(120, '\0'));
        CHECK_THROWS_WITH_AS(read_mesh(cut), doctest::Contains("found 204 bytes"), InputError);
    }

    TEST_CASE("a third triangle at an edge and an index that does not exist are refused") {
        const auto path = written("sheet.obj", tetrahedron + "f 2 3 4\nv 1 1 1\nf 2 3 5\n");
        CHECK_THROWS_WITH_AS(read_mesh(path), doctest::Contains("sheet.obj:10"), InputError);
        const auto missing = written("missing.obj", "v 0 0 0\nf 1 2 3\n");
        CHECK_THROWS_WITH_AS(read_mesh(missing), doctest::Contains("missing.obj:2"), InputError);
    }
}
