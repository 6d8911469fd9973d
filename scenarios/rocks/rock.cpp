#include "scenarios/rocks/rock.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/dimensions.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace bris {
namespace {

struct Plane {
    Vec3 normal;
    double distance;
};

/// Random planes whose normals are at least a share of the even spacing apart, so that the faces
/// are irregular but of comparable size.
std::vector<Plane> scattered_planes(const RockSettings& settings, Random& random) {
    std::vector<Plane> planes;
    double gap = 0.75 * std::sqrt(4 * pi / settings.faces);
    while (planes.size() < static_cast<std::size_t>(settings.faces)) {
        Vec3 candidate = random.direction();
        int trials = 0;
        const auto crowded = [&](const Plane& other) {
            return (other.normal - candidate).norm() < gap;
        };
        while (std::any_of(planes.begin(), planes.end(), crowded) && ++trials < 200)
            candidate = random.direction();
        if (trials >= 200) {
            gap *= 0.9;
            continue;
        }
        planes.push_back({candidate, 1 - settings.roughness * random.uniform()});
    }
    return planes;
}

/// Vertices of the intersection: points on three planes that no plane cuts off. O(n⁴), n <= 60.
std::vector<Vec3> corners(const std::vector<Plane>& planes) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (std::size_t j = i + 1; j < planes.size(); ++j)
            for (std::size_t k = j + 1; k < planes.size(); ++k) {
                Mat3 normals;
                normals << planes[i].normal.transpose(), planes[j].normal.transpose(),
                    planes[k].normal.transpose();
                if (std::abs(normals.determinant()) < 1e-6) continue;
                const Vec3 point = normals.inverse() *
                                   Vec3(planes[i].distance, planes[j].distance, planes[k].distance);
                const auto cut = [&](const Plane& plane) {
                    return plane.normal.dot(point) > plane.distance + 1e-9;
                };
                const auto same = [&](const Vec3& other) { return (other - point).norm() < 1e-7; };
                if (std::none_of(planes.begin(), planes.end(), cut) &&
                    std::none_of(points.begin(), points.end(), same))
                    points.push_back(point);
            }
    return points;
}

/// The convex solid that the planes enclose, with each face divided into a fan of triangles.
Polyhedron enclosed(const std::vector<Plane>& planes) {
    Polyhedron rock{.vertices = corners(planes), .triangles = {}, .faces = 0};
    for (const Plane& plane : planes) {
        std::vector<std::size_t> ring;
        Vec3 middle = Vec3::Zero();
        for (std::size_t v = 0; v < rock.vertices.size(); ++v)
            if (std::abs(plane.normal.dot(rock.vertices[v]) - plane.distance) < 1e-7) {
                ring.push_back(v);
                middle += rock.vertices[v];
            }
        if (ring.size() < 3) continue;
        middle /= static_cast<double>(ring.size());
        const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
        const auto angle = [&](std::size_t vertex) {
            const Vec3 arm = rock.vertices[vertex] - middle;
            return std::atan2(arm.dot(v), arm.dot(u));
        };
        std::sort(ring.begin(), ring.end(),
                  [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
        for (std::size_t k = 2; k < ring.size(); ++k)
            rock.triangles.push_back({ring[0], ring[k - 1], ring[k]});
        ++rock.faces;
    }
    return rock;
}

/// Rotates the polyhedron: its longest, intermediate and shortest dimensions lie along x, y, z.
Dimensions align(Polyhedron& rock) {
    const Dimensions dimensions = compute_dimensions(vertex_balls(rock));
    for (Vec3& vertex : rock.vertices) vertex = (dimensions.axes.transpose() * vertex).eval();
    return dimensions;
}

void check(const RockSettings& settings) {
    const auto refuse = [](const std::string& what, double found) {
        throw InputError("rock: expected " + what + ", found " + std::to_string(found));
    };
    if (!(settings.flat_elongated >= 1 && settings.flat_elongated <= 4))
        refuse("flat-and-elongated ratio in 1..4", settings.flat_elongated);
    if (!(settings.flatness >= 0 && settings.flatness <= 1))
        refuse("flatness in 0..1", settings.flatness);
    if (!(settings.faces >= 6 && settings.faces <= 60)) refuse("6 to 60 faces", settings.faces);
    if (!(settings.roughness >= 0 && settings.roughness <= 0.5))
        refuse("roughness in 0..0.5", settings.roughness);
}

/// Stretches the rock until the measured ratios are the wanted ones. Returns whether they are.
bool stretch(Polyhedron& rock, const RockSettings& settings) {
    const double flat = std::pow(settings.flat_elongated, settings.flatness);
    for (int round = 0; round < 60; ++round) {
        const Dimensions now = align(rock);
        const double ratio = now.flat_elongated();
        if (std::abs(ratio / settings.flat_elongated - 1) < 1e-3 &&
            std::abs(now.intermediate / now.shortest / flat - 1) < 0.02)
            return true;
        scale(rock, {std::sqrt(settings.flat_elongated / ratio),
                     std::sqrt(flat * now.shortest / now.intermediate), 1.0});
    }
    return false;
}

} // namespace

void scale(Polyhedron& polyhedron, const Vec3& factor) {
    for (Vec3& vertex : polyhedron.vertices) vertex = vertex.cwiseProduct(factor).eval();
}

std::vector<Ball> vertex_balls(const Polyhedron& polyhedron) {
    std::vector<Ball> balls;
    for (const Vec3& vertex : polyhedron.vertices) balls.push_back({vertex, 0.0});
    return balls;
}

Polyhedron make_rock(const RockSettings& settings, std::uint64_t seed, std::uint64_t index) {
    check(settings);
    Random random(seed, index);
    for (int trial = 0; trial < 100; ++trial) {
        const std::vector<Plane> planes = scattered_planes(settings, random);
        Polyhedron rock = enclosed(planes);
        // fewer than six well-spread planes, or none on one side, leave the solid open
        const std::size_t edges = rock.triangles.size() * 3 / 2;
        const bool closed = rock.vertices.size() + rock.triangles.size() == edges + 2;
        const auto far = [](const Vec3& vertex) { return vertex.norm() > 2.0; };
        if (!closed || std::any_of(rock.vertices.begin(), rock.vertices.end(), far)) continue;
        if (!stretch(rock, settings)) continue;
        scale(rock, Vec3::Constant(1 / sieve_size(vertex_balls(rock))));
        const Vec3 centre = mass_properties(rock).centre;
        for (Vec3& vertex : rock.vertices) vertex -= centre;
        return rock;
    }
    throw InputError("rock: no rock with flat-and-elongated ratio " +
                     std::to_string(settings.flat_elongated) + " and " +
                     std::to_string(settings.faces) + " faces in 100 trials; choose another ratio");
}

Polyhedron make_cube(double side) {
    require(side > 0 && std::isfinite(side), "cube: expected a positive side");
    Polyhedron cube;
    std::vector<Plane> planes;
    for (int axis = 0; axis < 3; ++axis)
        for (double sign : {-1.0, 1.0}) planes.push_back({sign * Vec3::Unit(axis), 1.0});
    cube = enclosed(planes);
    scale(cube, Vec3::Constant(0.5 * side));
    return cube;
}

MassProperties mass_properties(const Polyhedron& polyhedron) {
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    const Vec3 origin = polyhedron.vertices.front();
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3 a = polyhedron.vertices[i] - origin, b = polyhedron.vertices[j] - origin,
                   c = polyhedron.vertices[k] - origin;
        const double tetrahedron = a.dot(b.cross(c)) / 6;
        const Vec3 sum = a + b + c;
        volume += tetrahedron;
        first += tetrahedron / 4 * sum;
        second +=
            tetrahedron / 20 *
            (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    const Vec3 centre = first / volume;
    second -= volume * centre * centre.transpose();
    return {volume, origin + centre, second.trace() * Mat3::Identity() - second};
}

double surface_area(const Polyhedron& polyhedron) {
    double area = 0;
    for (const auto& [i, j, k] : polyhedron.triangles) {
        const Vec3& a = polyhedron.vertices[i];
        area += 0.5 * (polyhedron.vertices[j] - a).cross(polyhedron.vertices[k] - a).norm();
    }
    return area;
}

} // namespace bris
