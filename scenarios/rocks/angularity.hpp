#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <array>
#include <span>
#include <vector>

namespace bris {

/// Outline of a solid along a direction: a closed polygon, and its area.
using Outline = std::vector<std::array<double, 2>>;

/// Angularity of an outline after Rao, Tutumluer and Kim (2002), degrees: the outline becomes a
/// polygon of 24 equal lengths of perimeter; each of the 24 changes of the angle at a corner from
/// one corner to the next counts with the lower bound of its 10° class. The mean over 8 starting
/// points removes the dependence on where one starts. 0 for a circle; 400 to 600 for crushed rock.
double outline_angularity(const Outline& outline);

/// Area-weighted mean of the outline angularity over the three views along `axes`, degrees. Of a
/// polyhedron: the outline of its hull. The dents between the balls of a clump count, as they would
/// in a photograph; `hull_angularity` leaves them out and shows how round the corners have become.
double angularity(const Polyhedron& polyhedron, const Mat3& axes);
double angularity(std::span<const Ball> balls, const Mat3& axes);
double hull_angularity(std::span<const Ball> balls, const Mat3& axes);

} // namespace bris
