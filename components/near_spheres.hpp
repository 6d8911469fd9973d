#pragma once

#include "components/sphere.hpp"
#include "engine/lanes.hpp"

namespace bris {

/// Bit q of the result is set where the spheres own(q) and other(q) overlap, for q < lane_count.
/// Both return rows of positions and radii.
template <class Own, class Other>
unsigned near_lanes(Own&& own, Other&& other) {
    const Lane sign = in_each_row(Quad{-1, -1, -1, 1});
    const auto a = load_rows([&](int q) { return &own(q).x; });
    const auto b = load_rows([&](int q) { return &other(q).x; });
    FourLanes squares; // squared distance along each axis, minus the squared reach
    for (std::size_t q = 0; q < 4; ++q) {
        const Lane d = a[q] + sign * b[q];
        squares[q] = d * d * -sign;
    }
    return bits(row_sums(squares) < 0.0);
}

} // namespace bris
