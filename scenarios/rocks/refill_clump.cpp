#include "scenarios/rocks/refill_clump.hpp"

#include "engine/errors.hpp"
#include "scenarios/rocks/fill_clump.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "systems/output/surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

Polyhedron surface_of(const Clump& clump) {
    constexpr std::size_t rings = 12, sectors = 24; // 15 degrees
    std::vector<Vec3> directions{Vec3::UnitZ()};
    for (std::size_t r = 1; r < rings; ++r)
        for (std::size_t s = 0; s < sectors; ++s) {
            const double down = pi * static_cast<double>(r) / rings,
                         round = 2 * pi * static_cast<double>(s) / sectors;
            directions.emplace_back(std::sin(down) * std::cos(round),
                                    std::sin(down) * std::sin(round), std::cos(down));
        }
    directions.push_back(-Vec3::UnitZ());
    Polyhedron solid;
    solid.vertices = surface_corners(clump.balls, directions);
    for (const Vec3& corner : solid.vertices)
        require(corner != Vec3::Zero(),
                fmt::format("clump {}: expected its centre of mass inside it", clump.name));
    const std::size_t bottom = solid.vertices.size() - 1;
    const auto at = [&](std::size_t r, std::size_t s) {
        return 1 + (r - 1) * sectors + s % sectors;
    };
    for (std::size_t s = 0; s < sectors; ++s) {
        solid.triangles.push_back({0, at(1, s), at(1, s + 1)});
        for (std::size_t r = 1; r + 1 < rings; ++r) {
            solid.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
            solid.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
        }
        solid.triangles.push_back({at(rings - 1, s), bottom, at(rings - 1, s + 1)});
    }
    solid.faces = static_cast<int>(solid.triangles.size());
    return solid;
}

Clump refilled(const Clump& clump, unsigned spheres, std::uint64_t seed) {
    FillSettings settings;
    settings.fit.spheres = spheres;
    settings.fit.rounds = std::min<int>(settings.fit.rounds, 4 * static_cast<int>(spheres));
    settings.restarts = 1; // further starts are not worth their time: a coarse shape is wanted
    std::vector<Ball> balls = fill_clump(surface_of(clump), settings, seed);
    const MassProperties found = union_properties(balls);
    const double factor = std::cbrt(clump.volume / found.volume);
    Clump result = clump;
    result.bounding_radius = 0;
    for (Ball& ball : balls) {
        ball = {factor * (ball.centre - found.centre), factor * ball.radius};
        result.bounding_radius = std::max(result.bounding_radius, ball.centre.norm() + ball.radius);
    }
    result.balls = std::move(balls);
    return result;
}

} // namespace bris
