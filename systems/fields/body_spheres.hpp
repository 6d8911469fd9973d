#pragma once

#include "components/body.hpp"
#include "components/sphere.hpp"
#include "engine/world.hpp"
#include "systems/fields/voxels.hpp"

#include <vector>

namespace bris {

/// The spheres of all bodies at their present positions, body by body in the order of ids, of which
/// some may be missing. Computed from State alone, so that it serves before the first step and for
/// restored states.
struct BodySpheres {
    std::vector<Row> row;           ///< of each body
    std::vector<Row> first;         ///< bodies + 1
    std::vector<SphereRow> spheres; ///< m
    std::vector<Box3> box;          ///< m, around each body; low > high if it has no spheres
    std::vector<Pose> pose;

    std::size_t bodies() const { return row.size(); }
    bool has_spheres(std::size_t body) const { return first[body] < first[body + 1]; }
};
BodySpheres spheres_of_bodies(const World& world);

} // namespace bris
