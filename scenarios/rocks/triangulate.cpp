#include "scenarios/rocks/triangulate.hpp"

#include <algorithm>

namespace bris {

namespace {

using Point = std::array<double, 2>;

/// A corner of the polygon: its index, and where it is seen along the normal.
struct Corner {
    std::size_t index;
    Point at;
};

/// Twice the area of a triangle, positive if it is counter-clockwise.
double doubled_area(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The corners as seen along the coordinate axis nearest to the polygon's normal (Newell's sum), on
/// the side from which they are counter-clockwise.
std::vector<Corner> seen_flat(std::span<const Vec3> corners, std::span<const std::size_t> polygon) {
    Vec3 normal = Vec3::Zero();
    const Vec3& origin = corners[polygon[0]];
    for (std::size_t k = 0; k < polygon.size(); ++k)
        normal += (corners[polygon[k]] - origin)
                      .cross(corners[polygon[(k + 1) % polygon.size()]] - origin);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double side = normal[axis] < 0 ? -1 : 1;
    std::vector<Corner> flat;
    for (const std::size_t index : polygon) {
        const Vec3 x = corners[index] - origin;
        flat.push_back({index, {side * x[u], x[v]}});
    }
    return flat;
}

bool is_within(const Point& p, const Point& a, const Point& b, const Point& c) {
    return doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0;
}

/// Whether corner k can be cut off: it is convex, and its triangle contains no other corner. Where
/// the polygon touches itself, as at a bridge to a hole, the same point stands in it twice; twice
/// in succession it spans no triangle and can be cut off, too.
bool is_ear(const std::vector<Corner>& ring, std::size_t k) {
    const Corner &a = ring[(k + ring.size() - 1) % ring.size()], &b = ring[k],
                 &c = ring[(k + 1) % ring.size()];
    if (b.at == a.at || b.at == c.at) return true;
    if (!(doubled_area(a.at, b.at, c.at) > 0)) return false;
    return std::ranges::none_of(ring, [&](const Corner& other) {
        return other.at != a.at && other.at != b.at && other.at != c.at &&
               is_within(other.at, a.at, b.at, c.at);
    });
}

/// Whether two edges pass through each other.
bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    const auto differ = [](double x, double y) { return (x > 0 && y < 0) || (x < 0 && y > 0); };
    return differ(doubled_area(a, b, c), doubled_area(a, b, d)) &&
           differ(doubled_area(c, d, a), doubled_area(c, d, b));
}

bool crosses_itself(const std::vector<Corner>& ring) {
    const auto end_of = [&](std::size_t k) -> const Point& {
        return ring[(k + 1) % ring.size()].at;
    };
    for (std::size_t i = 0; i < ring.size(); ++i)
        for (std::size_t j = i + 2; j < ring.size(); ++j)
            if (cross(ring[i].at, end_of(i), ring[j].at, end_of(j))) return true;
    return false;
}

} // namespace

std::vector<std::array<std::size_t, 3>> triangulated(std::span<const Vec3> corners,
                                                     std::span<const std::size_t> polygon) {
    if (polygon.size() == 3) return {{polygon[0], polygon[1], polygon[2]}};
    std::vector<Corner> ring = seen_flat(corners, polygon);
    if (crosses_itself(ring)) return {};
    std::vector<std::array<std::size_t, 3>> triangles;
    while (ring.size() > 2) {
        // from the second corner on, so that a convex polygon becomes a fan
        std::size_t k = 1;
        while (k <= ring.size() && !is_ear(ring, k % ring.size())) ++k;
        if (k > ring.size()) return {};
        k %= ring.size();
        triangles.push_back({ring[(k + ring.size() - 1) % ring.size()].index, ring[k].index,
                             ring[(k + 1) % ring.size()].index});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(k));
    }
    return triangles;
}

} // namespace bris
