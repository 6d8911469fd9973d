#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/fit_spheres.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Method by which a solid is filled with spheres. `fitted` (fit_spheres.hpp) is the default: for
/// the rocks of the library its mean surface distance is 1.1 to 1.6 % of the sieve size. With
/// `level_set` (OpenVDB) it is 2.4 to 3.0 %, because these spheres touch the surface from inside
/// and therefore round off every corner. The scenario `clumps` measures both (report.csv).
enum class FillMethod { fitted, level_set };

struct FillSettings {
    FillMethod method = FillMethod::fitted;
    FitSettings fit;
    int restarts = 4; ///< fits from different starts; the best in surface and shape is kept
};

/// Fills a solid with overlapping spheres whose union has the volume of the solid to 1e-4 and, in
/// most cases, its principal moments of inertia. Returns settings.fit.spheres spheres (the level
/// set may give fewer) in the frame and size of the solid; make_clump turns them into a clump. The
/// result depends on the arguments and `seed` alone. Throws InputError if the solid is too thin for
/// spheres of the least radius.
std::vector<Ball> fill_clump(const Polyhedron& polyhedron, const FillSettings& settings,
                             std::uint64_t seed);

/// Fills a solid by OpenVDB's fillWithSpheres on a level set with 64 voxels across the sieve size
/// `size` (m). The spheres lie inside the surface, largest first; their volume is not adjusted.
std::vector<Ball> fill_level_set(const Polyhedron& polyhedron, double size,
                                 const FitSettings& settings);

/// Fills a cube of side 1 m about the origin with 30 spheres (8 at corners, 12 at edges, 6 at
/// faces, 4 inside). The arrangement has the symmetry of a tetrahedron, so that the three principal
/// moments are equal and the axes are those of the cube. Volume and inertia are those of the cube.
std::vector<Ball> fill_cube(const FitSettings& settings);

} // namespace bris
