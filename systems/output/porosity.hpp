#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"

namespace bris {

/// A vertical cylinder about the z axis, m.
struct CylinderRegion {
    double radius, low, high;
    double volume() const { return pi * radius * radius * (high - low); }
};

/// Volume (m3) of the union of all spheres inside the region, those of fixed rocks included. The
/// integration is exact along z (union of intervals) and uses `columns` x `columns` midpoints
/// across the diameter. Error: about 1/columns^1.5 of the volume of one rock's boundary; 3e-4 of
/// the total with 200 columns.
double solid_volume(const World& world, const CylinderRegion& region, int columns = 200);

/// Porosity of the region: 1 - solid volume / volume.
double porosity(const World& world, const CylinderRegion& region, int columns = 200);

/// A box with sides along the axes, m.
struct BoxRegion {
    Vec3 low, high;
};

/// Porosity of the box, by the same integration along vertical lines that are at most `pitch` (m)
/// apart.
double porosity(const World& world, const BoxRegion& region, double pitch);

} // namespace bris
