#pragma once

#include "components/clump.hpp"

#include <span>
#include <string>
#include <vector>

namespace bris {

/// Volume (m³), centre of mass (m) and inertia tensor about the centre of mass per unit density
/// (m⁵) of a solid.
struct MassProperties {
    double volume = 0;
    Vec3 centre = Vec3::Zero();
    Mat3 inertia = Mat3::Zero();
};

/// Computes the mass properties of the union of the spheres from `columns` × `columns` columns over
/// the bounding rectangle in x, y. The integration is exact along z (the overlapping intervals of a
/// column are merged) and uses the midpoint rule in x and y. The error is at most about
/// 4 / columns^1.5, due to the vertical tangents of the outline.
MassProperties union_properties(std::span<const Ball> balls, int columns);

/// The same, with the number of columns doubled until volume and inertia change by less than
/// `tolerance` (relative) and the centre of mass by less than `tolerance` times the size. Returns
/// the values of the finer grid, which are at least as accurate. Throws InputError for no spheres,
/// for a radius that is not positive and finite, or when 6400 columns are not enough.
MassProperties union_properties(std::span<const Ball> balls, double tolerance = 1e-5);

/// Principal moments of inertia and principal axes.
struct PrincipalAxes {
    Vec3 moments;
    Mat3 axes; ///< columns: the axes, right-handed
};

/// Computes eigenvalues and right-handed eigenvectors of a symmetric tensor by Jacobi rotations,
/// starting from the identity. Off-diagonal terms below 1e-7 of the trace are not rotated away, so
/// that axes which the solid does not define (a cube, a body of revolution) stay as given. The
/// moments are not sorted.
PrincipalAxes principal_axes(const Mat3& inertia);

/// Computes the side of the smallest square opening that the union of the spheres passes by
/// translation, m: the minimum over all orientations of the larger of two perpendicular extents.
/// Only the convex hull matters, so a polyhedron may be given as its vertices with radius 0.
/// Searches a lattice of rotations with local refinement; the error is below 1e-4 of the size.
/// Takes at most 5 ms for 30 spheres.
double sieve_size(std::span<const Ball> balls);

/// Makes a clump of the spheres in their given size, with the origin at its centre of mass and the
/// axes along its principal axes. Throws InputError as union_properties does.
Clump make_clump(const std::string& name, std::span<const Ball> balls);

} // namespace bris
