#include "systems/output/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace bris {

namespace {

/// The icosahedron: corners (0, +-1, +-t) and their cyclic permutations, t being the golden ratio.
constexpr std::array<std::array<std::int64_t, 3>, 20> icosahedron{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

std::vector<Vec3> icosahedron_corners() {
    const double t = (1 + std::sqrt(5.0)) / 2;
    return {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
            {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
}

} // namespace

TriangulatedSphere::TriangulatedSphere(unsigned levels)
    : corners(icosahedron_corners()), triangles(icosahedron.begin(), icosahedron.end()) {
    for (; levels > 0; --levels) {
        std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> middles;
        const auto middle = [&](std::int64_t a, std::int64_t b) {
            const auto [found, is_new] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::int64_t>(corners.size()));
            if (is_new)
                corners.push_back(corners[static_cast<std::size_t>(a)].normalized() +
                                  corners[static_cast<std::size_t>(b)].normalized());
            return found->second;
        };
        std::vector<std::array<std::int64_t, 3>> divided;
        for (const auto& [a, b, c] : triangles) {
            const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            divided.insert(divided.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        triangles = std::move(divided);
    }
    for (Vec3& corner : corners) corner.normalize();
}

std::vector<Vec3> surface_corners(std::span<const Ball> balls, std::span<const Vec3> directions) {
    std::vector<Vec3> corners;
    corners.reserve(directions.size());
    for (const Vec3& direction : directions) {
        double farthest = 0;
        for (const Ball& ball : balls) {
            const double along = direction.dot(ball.centre),
                         aside = ball.centre.squaredNorm() - along * along,
                         half = ball.radius * ball.radius - aside;
            if (half >= 0) farthest = std::max(farthest, along + std::sqrt(half));
        }
        corners.push_back(farthest * direction);
    }
    return corners;
}

} // namespace bris
