#pragma once

#include "components/clump.hpp"
#include "engine/math.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

/// A sphere of radius 1, divided into triangles: an icosahedron whose triangles were divided into
/// four `levels` times (level 3: 642 corners, 1 280 triangles, all of them seen from outside in
/// anticlockwise order).
struct TriangulatedSphere {
    explicit TriangulatedSphere(unsigned levels);
    std::vector<Vec3> corners;
    std::vector<std::array<std::int64_t, 3>> triangles;
};

/// The surface of a clump, seen from its centre of mass: for each direction (of length 1), the
/// farthest point in which the ray in this direction leaves one of the balls, in the frame of the
/// clump (m). These corners lie on the clump's surface exactly. A direction in which there is no
/// ball gives the centre. A clump with hollows that cannot be seen from its centre is shown without
/// them.
std::vector<Vec3> surface_corners(std::span<const Ball> balls, std::span<const Vec3> directions);

} // namespace bris
