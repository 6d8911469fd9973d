#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"
#include "systems/output/picture.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace bris {

/// State of the bodies with spheres that count on this rank, and of all facets, as written to a run
/// file. Bodies are in the order of their ids, regardless of their rows. n: number of bodies.
struct BodyFrame {
    double time = 0;                  ///< s
    std::vector<std::int64_t> ids;    ///< n
    std::vector<std::int64_t> shapes; ///< n, index in the clump library; empty in scenes of spheres
    std::vector<Vec3> positions;      ///< n, m
    std::vector<float> radii;         ///< n, m, bounding radius
    std::vector<float> velocities;    ///< n x 3, m/s, at the time of the positions
    std::vector<float> angular_velocities; ///< n x 3, rad/s
    std::vector<float> orientations;       ///< n x 4 (w, x, y, z); empty in scenes of spheres
    std::vector<float> coordination;       ///< n, touching bodies (boundaries count)
    std::vector<Vec3> corners;             ///< 4 per facet, m
    std::size_t quads() const { return corners.size() / 4; }
};

/// The frame of the bodies that count on this rank after the last step: of all in a world that is
/// not divided. Reads only.
BodyFrame frame_of_bodies(const World& world);

/// The bodies of a frame as a view to be drawn, sphere by sphere, at their present positions in the
/// world. `colour` is called with the index of a body in the frame. Facets become outlines.
View view_of_bodies(const World& world, const BodyFrame& frame,
                    const std::function<Colour(std::size_t index)>& colour);

/// The bodies with spheres that count on this rank, in the colours of their rows (nullopt: not
/// drawn), with the outlines of all facets.
View view_of_grains(const World& world,
                    const std::function<std::optional<Colour>(Row row)>& colour);
/// The same, coloured by coordination number, from blue (0)
/// to yellow (`most` and more).
View view_by_coordination(const World& world, double most = 8);
/// Gives the first rank what the views of all ranks show; the others then show no bodies.
void gather(View& view);

} // namespace bris
