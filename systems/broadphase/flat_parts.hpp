#pragma once

#include "components/sleeve.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris::detail {

/// A plane part of a surface, as far as lists need it.
struct FlatPart {
    Vec3 corner, normal;
    Eigen::AlignedBox3d box;

    FlatPart() = default;
    /// Of at least three corners; the first three are not in line.
    explicit FlatPart(std::span<const Vec3> corners)
        : corner(corners[0]),
          normal((corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized()) {
        for (const Vec3& c : corners) box.extend(Eigen::Vector3d(c));
    }
    /// Distances (m) of the part's plane and box from a point, both lower bounds of its own.
    double from_plane(const Vec3& x) const { return std::abs((x - corner).dot(normal)); }
    double from_box(const Vec3& x) const { return box.exteriorDistance(Eigen::Vector3d(x)); }

    /// Lower bound (m) of the gap between the part and a sphere, sharp if it is below `wanted`.
    double gap(const Vec3& centre, double radius, double wanted) const {
        const double height = from_plane(centre) - radius;
        return height >= wanted ? height : from_box(centre) - radius;
    }
};

/// The triangles of a sleeve.
inline std::vector<FlatPart> flat_parts_of_sleeve(const World& world) {
    const auto corners = world.column<Triangles, Corners>();
    const auto position = world.column<Nodes, NodePosition>();
    std::vector<FlatPart> parts;
    for (const TriangleNodes& t : corners)
        parts.push_back(
            FlatPart(std::array{position[t.node[0]], position[t.node[1]], position[t.node[2]]}));
    return parts;
}

} // namespace bris::detail
