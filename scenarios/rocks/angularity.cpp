#include "scenarios/rocks/angularity.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

double cross(const std::array<double, 2>& a, const std::array<double, 2>& b) {
    return a[0] * b[1] - a[1] * b[0];
}

double area(const Outline& outline) {
    double twice = 0;
    for (std::size_t k = 0; k < outline.size(); ++k)
        twice += cross(outline[k], outline[(k + 1) % outline.size()]);
    return 0.5 * twice;
}

/// `count` points at equal lengths of perimeter. `start`: position of the first, in units of one
/// such length, 0 to 1.
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
                if (cross({b[0] - a[0], b[1] - a[1]}, {point[0] - b[0], point[1] - b[1]}) > 0)
                    break;
                chain.pop_back();
            }
            chain.push_back(point);
        }
        chain.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return chain;
}

/// Outer outline of discs seen from `middle`: the farthest point along each of 1,440 rays.
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

} // namespace

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

} // namespace bris
