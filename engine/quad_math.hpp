#pragma once

#include "engine/lanes.hpp"
#include "engine/math.hpp"

namespace bris {

// Vectors of one body at a time, as half a cache line. Where a system does little arithmetic on
// many columns this is faster than lane_count bodies at a time, because nothing is transposed.

/// The vector, and 0 as fourth number.
inline Quad quad(const Vec3& v) { return Quad{v.x(), v.y(), v.z(), 0}; }
inline void store(Vec3& v, Quad a) { v = {a[0], a[1], a[2]}; }
/// The same vector with another fourth number.
inline Quad with_fourth(Quad a, double fourth) { return Quad{a[0], a[1], a[2], fourth}; }

} // namespace bris
