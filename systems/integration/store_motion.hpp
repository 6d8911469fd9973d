#pragma once

#include "components/body.hpp"
#include "engine/lane_math.hpp"

namespace bris {

/// Writes the rows of motion of lane_count bodies: m/s, 1/kg (0 if driven), rad/s.
inline void store_motion(MotionRow* motion, LaneRows rows, const QuadRows& v, const Lane& inverse_mass, const QuadRows& spin) {
    for (int q = 0; q < rows.count; ++q) {
        MotionRow& row = motion[rows.first + static_cast<Row>(q)];
        const double m = inverse_mass[q];
        store(&row.vx, with_fourth(v(q), Quad{m, m, m, m}));
        store(&row.spin_x, with_fourth(spin(q), Quad{}));
    }
}

} // namespace bris
