#include "scenarios/rocks/surface_distance.hpp"

#include "scenarios/rocks/lattice_direction.hpp"
#include "scenarios/rocks/nearest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

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

/// Points on the surface of the union, evenly spread over its area.
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

double signed_distance(const Polyhedron& polyhedron, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity(), solid_angle = 0;
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3 &a = polyhedron.vertices[i], &b = polyhedron.vertices[j],
                   &c = polyhedron.vertices[k];
        least = std::min(least, squared_distance(point, a, b, c));
        // Van Oosterom and Strackee (1983)
        const Vec3 x = a - point, y = b - point, z = c - point;
        const double lx = x.norm(), ly = y.norm(), lz = z.norm();
        solid_angle += 2 * std::atan2(x.dot(y.cross(z)),
                                      lx * ly * lz + x.dot(y) * lz + y.dot(z) * lx + z.dot(x) * ly);
    }
    return solid_angle > 2 * pi ? -std::sqrt(least) : std::sqrt(least);
}

std::vector<SurfacePoint> surface_points(const Polyhedron& polyhedron, std::size_t count) {
    std::vector<double> areas;
    double total = 0;
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3& a = polyhedron.vertices[i];
        areas.push_back(0.5 *
                        (polyhedron.vertices[j] - a).cross(polyhedron.vertices[k] - a).norm());
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
        if (outside >= 0) return outside; // exact; inside, the nearest of many points is used
        return nearest.distance(point);
    };
    SurfaceDistance result;
    const std::vector<SurfacePoint> points = surface_points(polyhedron, 4000);
    for (const SurfacePoint& point : points) {
        const double found = distance(point.position);
        result.mean += found / static_cast<double>(points.size());
        result.max = std::max(result.max, found);
    }
    for (const Vec3& vertex : polyhedron.vertices)
        result.max = std::max(result.max, distance(vertex));
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
