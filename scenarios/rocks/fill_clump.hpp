#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/fit_spheres.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// How a solid is filled. `fitted` (fit_spheres.hpp) is the default: on the library's rocks the
/// mean surface distance is 1.1 to 1.6 % of the sieve size against 2.4 to 3.0 % for OpenVDB's
/// filling, whose balls touch the surface from inside and therefore round off every corner (both
/// measured by `clumps`, columns of report.csv).
enum class FillMethod { fitted, level_set };

struct FillSettings {
    FillMethod method = FillMethod::fitted;
    FitSettings fit;
    int restarts = 4; ///< fits from different starts; the one nearest in surface and shape is kept
};

/// Overlapping balls (settings.fit.spheres of them; the level set may give fewer) whose union has
/// the volume of the solid to 1e-4 and, as a rule, its principal moments. In the solid's frame and
/// size; not yet a clump: see make_clump. Deterministic in `seed`. Throws InputError if the solid
/// is too thin for balls of the least radius.
std::vector<Ball> fill_clump(const Polyhedron& polyhedron, const FillSettings& settings,
                             std::uint64_t seed);

/// OpenVDB's sphere filling of a level set with 64 voxels across the sieve size `size`: balls
/// inside the surface, largest first, volume not adjusted.
std::vector<Ball> fill_level_set(const Polyhedron& polyhedron, double size,
                                 const FitSettings& settings);

/// A cube of 30 balls with the symmetry of a tetrahedron (8 corners, 12 edges, 6 faces, 4 inside),
/// so that its three principal moments are equal and its axes are those of the cube. Volume and
/// inertia as of the cube of side 1 m about the origin.
std::vector<Ball> fill_cube(const FitSettings& settings);

} // namespace bris
