#pragma once

#include "components/clump.hpp"

#include <span>
#include <string>
#include <vector>

namespace bris {

/// Volume (m³), centre of mass (m) and inertia tensor about it per unit density (m⁵) of a solid.
struct MassProperties {
    double volume = 0;
    Vec3 centre = Vec3::Zero();
    Mat3 inertia = Mat3::Zero();
};

/// Mass properties of the union of the balls from `columns` × `columns` columns over the bounding
/// rectangle in x, y: exact along z (the intervals of a column are merged), midpoint rule across.
/// Error about 4 / columns^1.5 at worst, from the vertical tangents of the outline.
MassProperties union_properties(std::span<const Ball> balls, int columns);

/// The same, the number of columns doubled until volume and inertia change by less than `tolerance`
/// (relative) and the first moment by less than `tolerance` of volume times size. The returned,
/// finer value is at least as good. Throws InputError for no balls, a radius that is not positive
/// and finite, or when 6400 columns are not enough.
MassProperties union_properties(std::span<const Ball> balls, double tolerance = 1e-5);

struct PrincipalAxes {
    Vec3 moments;
    Mat3 axes; ///< columns, right-handed
};

/// Eigenvalues and right-handed eigenvectors of a symmetric tensor by Jacobi rotations, begun at
/// the identity. Off-diagonal terms below 1e-7 of the trace are left alone: axes that the solid
/// does not define (a cube, a body of revolution) stay as they were given. Moments are not sorted.
PrincipalAxes principal_axes(const Mat3& inertia);

/// Side of the smallest square opening that the union of the balls passes by translation, m: the
/// least, over all orientations, of the larger of two extents at right angles. The opening sees the
/// hull only, so a polyhedron may be given as its vertices with radius 0. Search over a lattice of
/// rotations and local refinement, error below 1e-4 of the size. At most 5 ms for 30 balls.
double sieve_size(std::span<const Ball> balls);

/// A clump at the given size, moved to its centre of mass and turned to its principal axes.
/// Throws InputError as union_properties.
Clump make_clump(const std::string& name, std::span<const Ball> balls);

} // namespace bris
