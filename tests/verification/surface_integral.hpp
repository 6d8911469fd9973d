#pragma once

#include "scenarios/rocks/mass_properties.hpp"

#include <span>

namespace bris {

/// Mass properties of the union of the spheres by integrals over its surface (divergence theorem):
/// a sphere contributes those of its `points` points that no other sphere covers. This shares
/// nothing with the columns of union_properties. The error is of the order of points^-0.75 for one
/// sphere, because the border of the covered part cuts between points.
MassProperties surface_integrals(std::span<const Ball> balls, int points);

} // namespace bris
