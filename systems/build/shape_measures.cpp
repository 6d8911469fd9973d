#include "systems/build/shape_measures.hpp"

#include "engine/random.hpp"
#include "systems/build/nearest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bris {
namespace {

constexpr double golden_angle = 2.399963229728653; // pi (3 - sqrt 5)

/// Point k of n spread evenly over the unit sphere (Fibonacci lattice).
Vec3 lattice_direction(std::size_t k, std::size_t n) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(n);
    const double angle = golden_angle * static_cast<double>(k), s = std::sqrt(1 - z * z);
    return {s * std::cos(angle), s * std::sin(angle), z};
}

double width(std::span<const Ball> balls, const Vec3& direction) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Ball& ball : balls) {
        const double along = ball.centre.dot(direction);
        low = std::min(low, along - ball.radius);
        high = std::max(high, along + ball.radius);
    }
    return high - low;
}

Vec3 least_width_direction(std::span<const Ball> balls) {
    constexpr std::size_t lattice = 4000, kept = 12;
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t k = 0; k < lattice / 2; ++k) // widths are even: half the sphere is enough
        ranked.emplace_back(width(balls, lattice_direction(k, lattice)), k);
    for (std::size_t axis = 0; axis < 3; ++axis)
        ranked.emplace_back(width(balls, Vec3::Unit(static_cast<Eigen::Index>(axis))), lattice + axis);
    std::partial_sort(ranked.begin(), ranked.begin() + kept, ranked.end());
    Random random(2, 0);
    double least = std::numeric_limits<double>::infinity();
    Vec3 result = Vec3::UnitX();
    for (std::size_t k = 0; k < kept; ++k) {
        auto [best, index] = ranked[k];
        Vec3 direction = index < lattice ? lattice_direction(index, lattice)
                                         : Vec3::Unit(static_cast<Eigen::Index>(index - lattice));
        for (double step = 0.05; step > 1e-6; step *= 0.6)
            for (int trial = 0; trial < 16; ++trial) {
                const Vec3 moved = (direction + step * random.direction()).normalized();
                const double found = width(balls, moved);
                if (found < best) best = found, direction = moved;
            }
        if (best < least) least = best, result = direction;
    }
    return result;
}

/// Least width over the directions at right angles to `axis`: 720 angles, then golden section.
Vec3 least_width_across(std::span<const Ball> balls, const Vec3& axis) {
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    const auto at = [&](double angle) { return Vec3(std::cos(angle) * u + std::sin(angle) * v); };
    constexpr int angles = 720;
    double best = 0, least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < angles; ++k)
        if (const double found = width(balls, at(pi * k / angles)); found < least)
            least = found, best = pi * k / angles;
    for (double step = pi / angles; step > 1e-8; step *= 0.5)
        for (double side : {-step, step})
            if (const double found = width(balls, at(best + side)); found < least)
                least = found, best += side;
    return at(best);
}

double cross(const std::array<double, 2>& a, const std::array<double, 2>& b) {
    return a[0] * b[1] - a[1] * b[0];
}

double area(const Outline& outline) {
    double twice = 0;
    for (std::size_t k = 0; k < outline.size(); ++k)
        twice += cross(outline[k], outline[(k + 1) % outline.size()]);
    return 0.5 * twice;
}

/// `count` points at equal lengths of perimeter, the first at `start` (0 to 1) of one length.
Outline resampled(const Outline& outline, std::size_t count, double start) {
    const std::size_t n = outline.size();
    std::vector<double> along(n + 1, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        const auto &a = outline[k], &b = outline[(k + 1) % n];
        along[k + 1] = along[k] + std::hypot(b[0] - a[0], b[1] - a[1]);
    }
    Outline points;
    std::size_t k = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double target =
            (static_cast<double>(i) + start) / static_cast<double>(count) * along[n];
        while (k + 1 < n && along[k + 1] < target) ++k;
        const double length = along[k + 1] - along[k];
        const double t = length > 0 ? (target - along[k]) / length : 0.0;
        const auto &a = outline[k], &b = outline[(k + 1) % n];
        points.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
    return points;
}

double polygon_angularity(const Outline& polygon) {
    const std::size_t n = polygon.size();
    std::vector<double> angles(n);
    for (std::size_t k = 0; k < n; ++k) {
        const auto &a = polygon[(k + n - 1) % n], &b = polygon[k], &c = polygon[(k + 1) % n];
        const std::array<double, 2> in{b[0] - a[0], b[1] - a[1]}, out{c[0] - b[0], c[1] - b[1]};
        angles[k] = std::atan2(cross(in, out), in[0] * out[0] + in[1] * out[1]) * 180 / pi;
    }
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k)
        sum += 10 * std::floor(std::abs(angles[(k + 1) % n] - angles[k]) / 10 + 1e-9);
    return sum;
}

/// Convex hull (Andrew's monotone chain), counter-clockwise.
Outline hull(Outline points) {
    std::sort(points.begin(), points.end());
    Outline chain;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t base = chain.size();
        for (const auto& point : points) {
            while (chain.size() >= base + 2) {
                const auto &a = chain[chain.size() - 2], &b = chain.back();
                if (cross({b[0] - a[0], b[1] - a[1]}, {point[0] - b[0], point[1] - b[1]}) > 0) break;
                chain.pop_back();
            }
            chain.push_back(point);
        }
        chain.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return chain;
}

/// Outer outline of discs as seen from `middle`: the farthest point along 1,440 rays.
Outline disc_outline(std::span<const std::array<double, 3>> discs, std::array<double, 2> middle) {
    constexpr int rays = 1440;
    Outline outline;
    for (int k = 0; k < rays; ++k) {
        const double angle = 2 * pi * k / rays, ux = std::cos(angle), uy = std::sin(angle);
        double farthest = 0;
        for (const auto& [x, y, radius] : discs) {
            const double along = (x - middle[0]) * ux + (y - middle[1]) * uy;
            const double off = (x - middle[0]) * uy - (y - middle[1]) * ux;
            const double half_squared = radius * radius - off * off;
            if (half_squared > 0) farthest = std::max(farthest, along + std::sqrt(half_squared));
        }
        outline.push_back({middle[0] + farthest * ux, middle[1] + farthest * uy});
    }
    return outline;
}

struct View {
    Vec3 u, v;
};

std::array<View, 3> views(const Mat3& axes) {
    std::array<View, 3> result;
    for (int k = 0; k < 3; ++k)
        result[static_cast<std::size_t>(k)] = {axes.col((k + 1) % 3), axes.col((k + 2) % 3)};
    return result;
}

std::vector<Outline> union_outlines(std::span<const Ball> balls, const Mat3& axes) {
    Vec3 middle = Vec3::Zero();
    double total = 0;
    for (const Ball& ball : balls) {
        const double weight = ball.radius * ball.radius * ball.radius;
        middle += weight * ball.centre;
        total += weight;
    }
    middle /= total;
    std::vector<Outline> outlines;
    for (const View& view : views(axes)) {
        std::vector<std::array<double, 3>> discs;
        for (const Ball& ball : balls)
            discs.push_back({ball.centre.dot(view.u), ball.centre.dot(view.v), ball.radius});
        outlines.push_back(disc_outline(discs, {middle.dot(view.u), middle.dot(view.v)}));
    }
    return outlines;
}

double weighted_angularity(std::span<const Outline> outlines) {
    double sum = 0, total = 0;
    for (const Outline& outline : outlines) {
        const double weight = area(outline);
        sum += weight * outline_angularity(outline);
        total += weight;
    }
    return sum / total;
}

/// Squared distance of a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp);
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0) return ap.squaredNorm();
    if (d3 >= 0 && d4 <= d3) return bp.squaredNorm();
    if (d6 >= 0 && d5 <= d6) return cp.squaredNorm();
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
    const double height = ap.dot(ab.cross(ac));
    return height * height / ab.cross(ac).squaredNorm();
}

/// Points of the union's own surface, those of each ball in proportion to its area.
std::vector<Vec3> union_surface(std::span<const Ball> balls, double spacing) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const double r = balls[i].radius;
        const auto count = static_cast<std::size_t>(4 * pi * r * r / (spacing * spacing)) + 8;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 point = balls[i].centre + r * lattice_direction(k, count);
            bool hidden = false;
            for (std::size_t j = 0; j < balls.size() && !hidden; ++j)
                hidden = j != i && (point - balls[j].centre).squaredNorm() <
                                       balls[j].radius * balls[j].radius;
            if (!hidden) points.push_back(point);
        }
    }
    return points;
}

double typical_size(const Polyhedron& polyhedron) {
    return std::cbrt(mass_properties(polyhedron).volume);
}

} // namespace

Dimensions measure_dimensions(std::span<const Ball> balls) {
    const Vec3 shortest = least_width_direction(balls);
    const Vec3 intermediate = least_width_across(balls, shortest);
    const Vec3 longest = intermediate.cross(shortest);
    Dimensions result{width(balls, longest), width(balls, intermediate), width(balls, shortest), {}};
    result.axes << longest, intermediate, shortest;
    return result;
}

double outline_angularity(const Outline& outline) {
    constexpr std::size_t corners = 24, starts = 8;
    double sum = 0;
    for (std::size_t k = 0; k < starts; ++k)
        sum += polygon_angularity(resampled(outline, corners, static_cast<double>(k) / starts));
    return sum / starts;
}

double angularity(const Polyhedron& polyhedron, const Mat3& axes) {
    std::vector<Outline> outlines;
    for (const View& view : views(axes)) {
        Outline points;
        for (const Vec3& vertex : polyhedron.vertices)
            points.push_back({vertex.dot(view.u), vertex.dot(view.v)});
        outlines.push_back(hull(points));
    }
    return weighted_angularity(outlines);
}

double angularity(std::span<const Ball> balls, const Mat3& axes) {
    return weighted_angularity(union_outlines(balls, axes));
}

double hull_angularity(std::span<const Ball> balls, const Mat3& axes) {
    std::vector<Outline> outlines = union_outlines(balls, axes);
    for (Outline& outline : outlines) outline = hull(outline);
    return weighted_angularity(outlines);
}

double signed_distance(const Polyhedron& polyhedron, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity(), solid_angle = 0;
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3 &a = polyhedron.vertices[i], &b = polyhedron.vertices[j],
                   &c = polyhedron.vertices[k];
        least = std::min(least, squared_distance(point, a, b, c));
        // Van Oosterom and Strackee (1983)
        const Vec3 x = a - point, y = b - point, z = c - point;
        const double lx = x.norm(), ly = y.norm(), lz = z.norm();
        solid_angle += 2 * std::atan2(x.dot(y.cross(z)), lx * ly * lz + x.dot(y) * lz +
                                                             y.dot(z) * lx + z.dot(x) * ly);
    }
    return solid_angle > 2 * pi ? -std::sqrt(least) : std::sqrt(least);
}

std::vector<SurfacePoint> surface_points(const Polyhedron& polyhedron, std::size_t count) {
    std::vector<double> areas;
    double total = 0;
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3& a = polyhedron.vertices[i];
        areas.push_back(
            0.5 * (polyhedron.vertices[j] - a).cross(polyhedron.vertices[k] - a).norm());
        total += areas.back();
    }
    std::vector<SurfacePoint> points;
    double passed = 0;
    std::size_t index = 0;
    for (std::size_t t = 0; t < areas.size(); ++t) {
        const auto& [i, j, k] = polyhedron.triangles[t];
        const Vec3 &a = polyhedron.vertices[i], &b = polyhedron.vertices[j],
                   &c = polyhedron.vertices[k];
        const Vec3 normal = (b - a).cross(c - a).normalized();
        passed += areas[t];
        const double until = passed / total * static_cast<double>(count);
        for (; static_cast<double>(index) + 0.5 < until; ++index) {
            // the R2 sequence (Roberts 2018) folded onto the triangle
            double u = std::fmod(0.7548776662466927 * static_cast<double>(index), 1.0);
            double v = std::fmod(0.5698402909980532 * static_cast<double>(index), 1.0);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            points.push_back({a + u * (b - a) + v * (c - a), normal});
        }
    }
    return points;
}

SurfaceDistance distance_to_union(const Polyhedron& polyhedron, std::span<const Ball> balls) {
    const std::vector<Vec3> surface = union_surface(balls, 0.015 * typical_size(polyhedron));
    const NearestPoint nearest(surface);
    const auto distance = [&](const Vec3& point) {
        double outside = std::numeric_limits<double>::infinity();
        for (const Ball& ball : balls)
            outside = std::min(outside, (point - ball.centre).norm() - ball.radius);
        if (outside >= 0) return outside; // exact; inside, the nearest of many points is needed
        return nearest.distance(point);
    };
    SurfaceDistance result;
    const std::vector<SurfacePoint> points = surface_points(polyhedron, 4000);
    for (const SurfacePoint& point : points) {
        const double found = distance(point.position);
        result.mean += found / static_cast<double>(points.size());
        result.max = std::max(result.max, found);
    }
    for (const Vec3& vertex : polyhedron.vertices) result.max = std::max(result.max, distance(vertex));
    return result;
}

SurfaceDistance distance_to_polyhedron(const Polyhedron& polyhedron, std::span<const Ball> balls) {
    SurfaceDistance result;
    const std::vector<Vec3> points = union_surface(balls, 0.03 * typical_size(polyhedron));
    for (const Vec3& point : points) {
        const double found = std::abs(signed_distance(polyhedron, point));
        result.mean += found / static_cast<double>(points.size());
        result.max = std::max(result.max, found);
    }
    return result;
}

} // namespace bris
