#include "engine/assets.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "systems/output/surfaces.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <map>

using namespace bris;

namespace {

double volume_of(const TriangulatedSphere& sphere, const std::vector<Vec3>& corners) {
    double volume = 0;
    for (const auto& [a, b, c] : sphere.triangles)
        volume +=
            corners[static_cast<std::size_t>(a)].dot(
                corners[static_cast<std::size_t>(b)].cross(corners[static_cast<std::size_t>(c)])) /
            6;
    return volume;
}

} // namespace

TEST_SUITE("output/surfaces") {
    TEST_CASE("the triangles of a sphere are closed and seen from outside") {
        const TriangulatedSphere sphere(3);
        CHECK(sphere.corners.size() == 642);
        CHECK(sphere.triangles.size() == 1280);
        std::map<std::pair<std::int64_t, std::int64_t>, int> edges;
        for (const auto& [a, b, c] : sphere.triangles)
            for (const auto& edge : {std::pair{a, b}, {b, c}, {c, a}}) ++edges[edge];
        for (const auto& [edge, count] : edges) {
            CHECK(count == 1);
            CHECK(edges.contains({edge.second, edge.first}));
        }
        // A corner angle of e = 0.14 rad between neighbours lowers the middle of a triangle by
        // about e^2 / 6, and volume by three times the mean, which is half of that: 1 %.
        CHECK(volume_of(sphere, sphere.corners) == about(4 * pi / 3).epsilon(0.012));
        CHECK(volume_of(sphere, sphere.corners) < 4 * pi / 3);
    }

    TEST_CASE("the corners of a clump's surface lie on one of its balls and within none") {
        const Clump rock = read_clump(assets_folder() / "clumps/rock_01.csv");
        const TriangulatedSphere sphere(3);
        const auto corners = surface_corners(rock.balls, sphere.corners);
        REQUIRE(corners.size() == sphere.corners.size());
        for (const Vec3& corner : corners) {
            double nearest = 1e9;
            for (const Ball& ball : rock.balls)
                nearest = std::min(nearest, (corner - ball.centre).norm() - ball.radius);
            CHECK(std::abs(nearest) < 1e-12);
        }
        // Chords cut off about 1 % as above, and more at the small spheres of the corners.
        CHECK(volume_of(sphere, corners) == about(rock.volume).epsilon(0.03));
    }

    TEST_CASE("a direction without a ball gives the centre") {
        const std::vector<Ball> balls{{Vec3(1, 0, 0), 0.5}};
        const std::vector<Vec3> directions{Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX()};
        const auto corners = surface_corners(balls, directions);
        CHECK(corners[0] == Vec3(1.5, 0, 0));
        CHECK(corners[1] == Vec3::Zero());
        CHECK(corners[2].norm() == 0);
    }
}
