#include "scenarios/rocks/fill_clump.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/angularity.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/surface_distance.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace bris {
namespace {

/// Misfit of a fill, as a length relative to the size: surface, flatness and angularity, weighted
/// by the accuracy that can be reached (a mean distance of 0.01, ratios of 0.05 and 0.3).
double badness(const Polyhedron& solid, std::span<const Ball> balls, double size) {
    const Dimensions wanted = compute_dimensions(vertex_balls(solid));
    const double flat_elongated =
        compute_dimensions(balls).flat_elongated() / wanted.flat_elongated() - 1;
    const double sharp = angularity(balls, wanted.axes) / angularity(solid, wanted.axes) - 1;
    const double distance =
        0.5 * (distance_to_union(solid, balls).mean + distance_to_polyhedron(solid, balls).mean);
    return distance / size + 0.15 * std::abs(flat_elongated) + 0.02 * std::abs(sharp);
}

/// Free positions and radii of the spheres that fill a cube of half side 1/2.
struct CubePlan {
    double corner, corner_radius, edge, edge_radius, face, face_radius;
};

std::vector<Ball> planned(const CubePlan& plan) {
    std::vector<Ball> balls;
    for (int k = 0; k < 8; ++k) {
        const Vec3 signs(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
        balls.push_back({plan.corner * signs, plan.corner_radius});
        // the inner spheres lie in four of the eight octants, which form a tetrahedron
        if (signs.prod() > 0) balls.push_back({0.1 * signs, 0.3});
    }
    for (int axis = 0; axis < 3; ++axis)
        for (double a : {-1.0, 1.0}) {
            balls.push_back({a * plan.face * Vec3::Unit(axis), plan.face_radius});
            for (double b : {-1.0, 1.0})
                balls.push_back(
                    {plan.edge * (a * Vec3::Unit((axis + 1) % 3) + b * Vec3::Unit((axis + 2) % 3)),
                     plan.edge_radius});
        }
    return balls;
}

double cube_misfit(std::span<const Ball> balls, std::span<const SurfacePoint> points) {
    double sum = 0;
    for (const SurfacePoint& point : points) {
        double least = std::numeric_limits<double>::infinity();
        for (const Ball& ball : balls)
            least = std::min(least, (point.position - ball.centre).norm() - ball.radius);
        sum += std::pow(std::abs(least), 3) * (least < 0 ? 2 : 1);
    }
    return sum;
}

} // namespace

std::vector<Ball> fill_level_set(const Polyhedron& polyhedron, double size,
                                 const FitSettings& settings) {
    openvdb::initialize();
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const Vec3& vertex : polyhedron.vertices)
        points.emplace_back(static_cast<float>(vertex.x()), static_cast<float>(vertex.y()),
                            static_cast<float>(vertex.z()));
    for (const auto& [i, j, k] : polyhedron.triangles)
        triangles.emplace_back(static_cast<openvdb::Index32>(i), static_cast<openvdb::Index32>(j),
                               static_cast<openvdb::Index32>(k));
    const double voxel = size / 64;
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    const auto grid =
        openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles);
    std::vector<openvdb::Vec4s> spheres;
    const auto count = static_cast<int>(settings.spheres);
    openvdb::tools::fillWithSpheres(*grid, spheres, openvdb::Vec2i(1, count), true,
                                    static_cast<float>(settings.min_radius * size / voxel));
    std::vector<Ball> balls;
    for (const openvdb::Vec4s& sphere : spheres)
        balls.push_back({Vec3(static_cast<double>(sphere[0]), static_cast<double>(sphere[1]),
                              static_cast<double>(sphere[2])),
                         static_cast<double>(sphere[3])});
    require(!balls.empty(), "fill: no sphere of radius " +
                                std::to_string(settings.min_radius * size) +
                                " m fits into the solid; choose a smaller least radius");
    return balls;
}

std::vector<Ball> fill_clump(const Polyhedron& polyhedron, const FillSettings& settings,
                             std::uint64_t seed) {
    const std::vector<Ball> hull = vertex_balls(polyhedron);
    const double size = sieve_size(hull);
    require(settings.fit.spheres >= 4, "fill: expected at least 4 spheres");
    require(compute_dimensions(hull).shortest > 2 * settings.fit.min_radius * size,
            "fill: the solid is thinner than the smallest sphere; choose a smaller least radius");
    if (settings.method == FillMethod::level_set) {
        std::vector<Ball> balls = fill_level_set(polyhedron, size, settings.fit);
        match_moments(polyhedron, balls);
        return balls;
    }
    std::vector<Ball> best;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < std::max(1, settings.restarts); ++k) {
        const std::uint64_t key = seed * 1000 + static_cast<std::uint64_t>(k);
        FitSettings fit = settings.fit; // the starts differ in their weights, too
        if (k % 2 == 1) fit.extreme_weight *= 3;
        if (k % 4 >= 2) fit.corner_weight *= 3;
        std::vector<Ball> balls = fit_spheres(polyhedron, size, fit, key);
        match_moments(polyhedron, balls);
        if (const double found = badness(polyhedron, balls, size); found < least)
            least = found, best = std::move(balls);
    }
    return best;
}

std::vector<Ball> fill_cube(const FitSettings& settings) {
    const Polyhedron cube = make_cube(1.0);
    const std::vector<SurfacePoint> points = surface_points(cube, 1200);
    std::array<double, 6> values{0.36, 0.14, 0.34, 0.16, 0.05, 0.45};
    const auto balls_of = [&](const std::array<double, 6>& v) {
        return planned({v[0], v[1], v[2], v[3], v[4], v[5]});
    };
    // random search with a decreasing step: the misfit is cheap and not smooth
    Random random(1, 0);
    double least = cube_misfit(balls_of(values), points);
    for (double step = 0.04; step > 1e-4; step *= 0.8)
        for (int round = 0; round < 40; ++round) {
            std::array<double, 6> trial = values;
            for (double& value : trial) value += step * random.normal();
            if (std::min({trial[1], trial[3], trial[5]}) < settings.min_radius) continue;
            if (const double found = cube_misfit(balls_of(trial), points); found < least)
                least = found, values = trial;
        }
    std::vector<Ball> balls = balls_of(values);
    match_moments(cube, balls);
    return balls;
}

} // namespace bris
