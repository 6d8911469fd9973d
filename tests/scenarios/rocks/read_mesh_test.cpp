// Meshes as others write them: the same solid gives the same descriptors, however its surface is
// divided, numbered and stored.
#include "engine/errors.hpp"
#include "scenarios/rocks/angularity.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/make_library.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "scenarios/rocks/rock.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

using namespace bris;

namespace {

const std::string prism_corners = "v 0 0 0\nv 30 0 0\nv 30 10 0\nv 10 10 0\nv 10 30 0\nv 0 30 0\n"
                                  "v 0 0 15\nv 30 0 15\nv 30 10 15\nv 10 10 15\nv 10 30 15\n"
                                  "v 0 30 15\n";
const std::string prism_sides = "f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\n"
                                "f 6 1 7 12\n";
/// An L-shaped prism whose caps are one concave polygon each, from any corner.
std::string prism(std::size_t first = 0) {
    std::vector<int> low{6, 5, 4, 3, 2, 1}, high{7, 8, 9, 10, 11, 12};
    std::string faces;
    for (auto* cap : {&low, &high}) {
        std::ranges::rotate(*cap, cap->begin() + static_cast<std::ptrdiff_t>(first));
        faces += "f";
        for (const int corner : *cap) faces += fmt::format(" {}", corner);
        faces += "\n";
    }
    return prism_corners + faces + prism_sides;
}
const std::string box = "v 0 0 0\nv 0 0 15\nv 0 20 0\nv 0 20 15\nv 30 0 0\nv 30 0 15\nv 30 20 0\n"
                        "v 30 20 15\n";
const std::string box_faces = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";

struct Descriptors {
    double volume, area, flat_elongated, angularity;
};

Descriptors descriptors_of(const Polyhedron& solid) {
    double area = 0;
    for (const auto& [i, j, k] : solid.triangles)
        area += 0.5 * (solid.vertices[j] - solid.vertices[i])
                          .cross(solid.vertices[k] - solid.vertices[i])
                          .norm();
    const Dimensions dimensions = compute_dimensions(vertex_balls(solid));
    return {mass_properties(solid).volume, area, dimensions.flat_elongated(),
            angularity(solid, dimensions.axes)};
}

void check_same(const Polyhedron& solid, const Polyhedron& other, double tolerance = 1e-9) {
    const Descriptors a = descriptors_of(solid), b = descriptors_of(other);
    CHECK(a.volume == about(b.volume).epsilon(tolerance));
    CHECK(a.area == about(b.area).epsilon(tolerance));
    CHECK(a.flat_elongated == about(b.flat_elongated).epsilon(std::max(1e-6, tolerance)));
    CHECK(a.angularity == about(b.angularity).epsilon(std::max(1e-6, tolerance)));
}

/// Files in a folder of their own, read as soon as they are written.
struct Files {
    TemporaryDirectory folder;
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
        return folder / name;
    }
    Polyhedron read(const std::string& name, const std::string& text) const {
        return read_mesh(write(name, text));
    }
    std::string refusal(const std::string& name, const std::string& text) const {
        const auto path = write(name, text);
        const std::string message = message_of<InputError>([&] { (void)read_mesh(path); });
        return message.substr(message.find(name));
    }
};

std::string text_stl(const Polyhedron& solid, int digits, bool from_behind = false) {
    std::string text = "solid rock\n";
    auto triangles = solid.triangles;
    if (from_behind) std::ranges::reverse(triangles);
    for (const auto& triangle : triangles) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const std::size_t corner : triangle) {
            const Vec3& x = solid.vertices[corner];
            text +=
                fmt::format("vertex {1:.{0}g} {2:.{0}g} {3:.{0}g}\n", digits, x.x(), x.y(), x.z());
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid\n";
}

/// Each triangle divided at its centre and each edge at its middle.
Polyhedron divided(const Polyhedron& solid) {
    Polyhedron fine{.vertices = solid.vertices, .triangles = {}, .faces = 0};
    const auto add = [&](const Vec3& x) { // each middle once
        const auto found = std::ranges::find(fine.vertices, x);
        if (found == fine.vertices.end()) fine.vertices.push_back(x);
        return static_cast<std::size_t>(std::ranges::find(fine.vertices, x) -
                                        fine.vertices.begin());
    };
    for (const auto& t : solid.triangles) {
        const auto at = [&](std::size_t k) { return solid.vertices[t[k % 3]]; };
        const std::size_t centre = add((at(0) + at(1) + at(2)) / 3);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t middle = add(0.5 * (at(k) + at(k + 1)));
            fine.triangles.push_back({t[k], middle, centre});
            fine.triangles.push_back({middle, t[(k + 1) % 3], centre});
        }
    }
    return fine;
}

} // namespace

TEST_SUITE("rocks/read_mesh") {
    TEST_CASE("concave polygons are divided within their outline, from whatever corner they "
              "begin, in OBJ and PLY files") {
        const Files files;
        for (std::size_t first = 0; first < 6; ++first) {
            const Descriptors found = descriptors_of(files.read("prism.obj", prism(first)));
            CHECK(found.volume == about(7500).epsilon(1e-12));
            CHECK(found.area == about(2800).epsilon(1e-12));
        }
        std::string ply = "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty "
                          "double y\nproperty double z\nelement face 8\n"
                          "property list uchar int vertex_indices\nend_header\n";
        for (const double z : {0.0, 15.0})
            for (const auto& [x, y] :
                 {std::pair{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 30}, {0, 30}})
                ply += fmt::format("{} {} {}\n", x, y, z);
        ply += "6 1 0 5 4 3 2\n6 7 8 9 10 11 6\n";
        for (int k = 0; k < 6; ++k)
            ply += fmt::format("4 {} {} {} {}\n", k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6);
        check_same(files.read("prism.ply", ply), files.read("prism.obj", prism()));
    }

    TEST_CASE("a clump's report has the descriptors of the solid, however its caps are divided") {
        const Files files;
        const auto row_of = [&](const std::string& text) {
            LibrarySettings settings;
            settings.mesh = files.write("rock.obj", text);
            settings.out = files.folder / "out";
            settings.fill.fit.spheres = 8;
            settings.fill.restarts = 1;
            return make_library(settings).front();
        };
        const LibraryRow concave = row_of(prism(4));
        // the surface of a sphere of 7500 over 2800
        CHECK(concave.sphericity_solid ==
              about(std::cbrt(pi) * std::pow(6 * 7500.0, 2.0 / 3) / 2800).epsilon(1e-9));
        const LibraryRow plain = row_of(box + box_faces),
                         stray = row_of(box + "v 230 30 -80\n" + box_faces);
        CHECK(plain.flat_elongated_solid == about(2).epsilon(1e-4));
        CHECK(stray.flat_elongated_solid == plain.flat_elongated_solid);
        CHECK(stray.to_solid_mean == plain.to_solid_mean);
    }

    TEST_CASE("polygons with corners on their sides, a bridge to a hole, and corners given twice "
              "are divided") {
        const Files files;
        const auto pyramid = [&](const std::string& base, const std::string& more = "") {
            return files.read("pyramid.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\n"
                                             "v 2 0 0\nv 4 2 0\n" +
                                                 base + more);
        };
        const std::string sides = "f 1 6 5\nf 6 2 5\nf 2 7 5\nf 7 3 5\nf 3 4 5\nf 4 1 5\n";
        for (const char* base : {"f 4 3 7 2 6 1\n", "f 2 6 1 4 3 7\n", "f 7 2 6 1 4 3\n"})
            CHECK(mass_properties(pyramid(base, sides)).volume == about(16).epsilon(1e-12));
        CHECK(mass_properties(pyramid("f 4 4 3 7 2 6 6 1\n", sides)).volume ==
              about(16).epsilon(1e-12));
        // a square tube: each end is one polygon that goes around the outside, over a bridge,
        // around the hole, and back
        std::string tube;
        for (const int z : {0, 1})
            for (const auto& [x, y] :
                 {std::pair{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}})
                tube += fmt::format("v {} {} {}\n", x, y, z);
        tube += "f 1 4 3 2 1 5 6 7 8 5\nf 9 10 11 12 9 13 16 15 14 13\n";
        for (int k = 0; k < 4; ++k) {
            const int next = (k + 1) % 4;
            tube += fmt::format("f {} {} {} {}\nf {} {} {} {}\n", 1 + k, 1 + next, 9 + next, 9 + k,
                                5 + next, 5 + k, 13 + k, 13 + next);
        }
        CHECK(mass_properties(files.read("tube.obj", tube)).volume == about(8).epsilon(1e-12));
    }

    TEST_CASE("a polygon that cannot be divided is refused with file and line") {
        const Files files;
        const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\n";
        CHECK(files.refusal("bow.obj", corners + "f 1 3 2 4\n") ==
              "bow.obj:7: mesh: expected a polygon with an area that does not cross itself, found "
              "one of 4 corners that cannot be divided into triangles");
        CHECK(files.refusal("line.obj", corners + "f 1 2 5 6\n").starts_with("line.obj:7: mesh: "));
        CHECK(files.refusal("finite.ply",
                            "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\n"
                            "property double y\nproperty double z\nelement face 1\n"
                            "property list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n1 1 0\n0 inf 0\n4 0 1 2 3\n") ==
              "finite.ply:14: mesh: expected finite coordinates");
        std::string many = corners + "f";
        for (int k = 0; k < 1001; ++k) many += fmt::format(" {}", 1 + k % 4);
        CHECK(files.refusal("many.obj", many + "\n") ==
              "many.obj:7: mesh: expected at most 1000 corners of a polygon, found 1001");
    }

    TEST_CASE("the same solid has the same descriptors with unused corners, another division, "
              "another order of faces, as an STL file and in single precision") {
        const Files files;
        for (const std::uint64_t index : {1u, 2u}) {
            const Polyhedron rock =
                index == 1 ? make_rock({.faces = 12}, 3, index) : files.read("prism.obj", prism());
            const auto obj = [&](const Polyhedron& solid, const std::string& more, bool turned) {
                std::string text = more;
                const std::size_t before =
                    static_cast<std::size_t>(std::ranges::count(more, 'v')) + 1;
                for (const Vec3& x : solid.vertices)
                    text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
                auto triangles = solid.triangles;
                if (turned) std::ranges::reverse(triangles);
                for (const auto& [i, j, k] : triangles)
                    text += fmt::format("f {} {} {}\n", before + (turned ? j : i),
                                        before + (turned ? k : j), before + (turned ? i : k));
                return text;
            };
            check_same(files.read("a.obj", obj(rock, "", false)), rock);
            check_same(files.read("b.obj", obj(rock, "", true)), rock);
            // a point of a turntable 3 km away
            const Polyhedron beside =
                files.read("c.obj", obj(rock, "v 3e6 0 0\nv 0.1 0.2 -3e6\n", false));
            CHECK(beside.vertices.size() == rock.vertices.size());
            check_same(beside, rock);
            check_same(files.read("d.obj", obj(divided(rock), "", false)), rock);
            check_same(files.read("e.stl", text_stl(rock, 17)), rock);
            check_same(files.read("f.stl", text_stl(rock, 17, true)), rock);
            check_same(files.read("g.stl", text_stl(rock, 8)), rock, 1e-5);
        }
    }

    TEST_CASE("triangles smaller than a millionth of the extent stay, and the sides of a crack of "
              "a thousandth of an edge are joined") {
        const Files files;
        // a needle: its tip has faces of 1e-7 of its length
        const std::string needle = "v 0 0 0\nv 1e-7 0 0\nv 0 1e-7 0\nv 0 0 1\n"
                                   "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
        CHECK(files.read("needle.obj", needle).triangles.size() == 4);
        Polyhedron cube = make_cube(2);
        const std::string whole = text_stl(cube, 17);
        std::string cracked = whole; // one corner of one triangle is off
        const std::string corner = "vertex 1 1 1\n";
        REQUIRE(cracked.find(corner) != std::string::npos);
        cracked.replace(cracked.find(corner), corner.size(), "vertex 1.001 1 1\n");
        const Polyhedron joined = files.read("cracked.stl", cracked);
        CHECK(joined.vertices.size() == 8);
        CHECK(mass_properties(joined).volume == about(8).epsilon(2e-3));
        cracked.replace(cracked.find("1.001"), 5, "1.1");
        CHECK(files.refusal("open.stl", cracked).find("expected a closed surface") !=
              std::string::npos);
    }

    TEST_CASE("two bodies that touch in a point are no rock") {
        const Files files;
        const std::string two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\n"
                                "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
                                "f 1 5 6\nf 1 7 5\nf 1 6 7\nf 5 7 6\n";
        CHECK(files.refusal("two.obj", two)
                  .starts_with("two.obj:12: mesh: expected one closed surface, found another"));
    }
}
