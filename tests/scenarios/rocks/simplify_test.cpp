#include "scenarios/rocks/rock.hpp"
#include "scenarios/rocks/simplify.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <map>
#include <utility>

using namespace bris;

namespace {

/// Each triangle in four, by the middles of its edges.
Polyhedron divided(const Polyhedron& surface) {
    Polyhedron fine{surface.vertices, {}, surface.faces};
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middle;
    const auto between = [&](std::size_t a, std::size_t b) {
        const auto [at, is_new] = middle.try_emplace(std::minmax(a, b), fine.vertices.size());
        if (is_new) fine.vertices.push_back((surface.vertices[a] + surface.vertices[b]) / 2);
        return at->second;
    };
    for (const auto& [a, b, c] : surface.triangles) {
        const std::size_t ab = between(a, b), bc = between(b, c), ca = between(c, a);
        fine.triangles.push_back({a, ab, ca});
        fine.triangles.push_back({ab, b, bc});
        fine.triangles.push_back({ca, bc, c});
        fine.triangles.push_back({ab, bc, ca});
    }
    return fine;
}

/// Whether every edge is traversed as often in one direction as in the other.
bool is_closed(const Polyhedron& surface) {
    std::map<std::pair<std::size_t, std::size_t>, int> turns;
    for (const auto& [a, b, c] : surface.triangles)
        for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
            turns[std::minmax(from, to)] += from < to ? 1 : -1;
    for (const auto& [edge, sum] : turns)
        if (sum != 0) return false;
    return true;
}

} // namespace

TEST_SUITE("rocks/simplify") {
    TEST_CASE("a rock of many triangles keeps its volume, its faces and its sharp edges with few, "
              "and stays closed") {
        for (std::uint64_t index = 0; index < 3; ++index) {
            const Polyhedron rock = make_rock({.faces = 9}, 1, index);
            Polyhedron fine = rock;
            while (fine.triangles.size() < 60000) fine = divided(fine);
            const Polyhedron coarse = simplified(fine, 4000);
            CHECK(coarse.triangles.size() <= 4000);
            CHECK(coarse.triangles.size() > 2000);
            CHECK(is_closed(coarse));
            const double volume = mass_properties(rock).volume;
            CHECK(mass_properties(coarse).volume == about(volume).epsilon(2e-3));
            const Deviation deviation = deviation_of(coarse, fine, 1000);
            CHECK(deviation.mean < 2e-4);    // of a sieve size of 1
            CHECK(deviation.largest < 2e-2); // half a cell of the grid
        }
    }

    TEST_CASE("a surface that has few triangles is left as it is") {
        const Polyhedron cube = make_cube(1);
        CHECK(simplified(cube, 100).triangles == cube.triangles);
        CHECK(deviation_of(cube, cube, 10).largest < 1e-15);
    }
}
