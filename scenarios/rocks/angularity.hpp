#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <array>
#include <span>
#include <vector>

namespace bris {

/// Outline of a solid seen along a direction: a closed polygon.
using Outline = std::vector<std::array<double, 2>>;

/// Angularity index of an outline, degrees (Rao, Tutumluer and Kim 2002). The outline is resampled
/// to 24 points at equal lengths of perimeter. Each of the 24 changes of the corner angle from one
/// corner to the next contributes the lower bound of its 10° class. The index is averaged over 8
/// starting points, so that it does not depend on where the resampling starts. 0 for a circle; 400
/// to 600 for crushed rock.
double outline_angularity(const Outline& outline);

/// Mean of the outline angularity over the three views along the columns of `axes`, weighted by the
/// area of each outline, degrees. The outline of a polyhedron is that of its convex hull. The
/// outline of a clump includes the dents between its spheres, as a photograph would.
double angularity(const Polyhedron& polyhedron, const Mat3& axes);
double angularity(std::span<const Ball> balls, const Mat3& axes);
/// The same for the convex hull of a clump: without the dents, it shows how much the spheres round
/// the corners.
double hull_angularity(std::span<const Ball> balls, const Mat3& axes);

} // namespace bris
