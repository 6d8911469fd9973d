#pragma once

#include "engine/math.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace bris {

/// Divides a polygon into triangles of the same orientation by clipping ears (G. H. Meisters,
/// Polygons have ears, Amer. Math. Monthly 82, 1975), so that they cover it and nothing else also
/// where it is concave. `polygon`: indices into `corners`, at least three; the polygon may be
/// slightly warped and is seen along its mean normal. Convex polygons become the fan from the first
/// corner. Returns nothing if the polygon has no area or crosses itself.
std::vector<std::array<std::size_t, 3>> triangulated(std::span<const Vec3> corners,
                                                     std::span<const std::size_t> polygon);

} // namespace bris
