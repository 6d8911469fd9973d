#pragma once

#include "components/body.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Bodies that have come to rest are left where they are, and nothing is computed of them, until a
/// partner's push wakes them. An approximation, off unless a scene asks (add_sleep). A free body
/// sleeps once, for `steps` steps in a row, what is left of the forces on it could not accelerate
/// it by more than `acceleration`, turning included, and no point of it moved faster than `speed`;
/// it wakes when twice that acceleration is left. So where all sleep, no body lacks more than the
/// share 2 acceleration / g of its weight.
struct Sleep {
    static constexpr auto name = "sleep";
    double acceleration = 0.01 * 9.81; ///< m/s2, > 0
    double speed = 1e-4;               ///< m/s, > 0
    unsigned steps = 100;              ///< > 0
    // what review_sleep looked at last
    std::vector<std::uint8_t> sleeps = {}; ///< by row
    bool again = false; ///< in the next step: pairs that fell asleep were looked at once more
};

/// Steps in a row in which a body was at rest; from Sleep::steps on it sleeps.
struct Resting : State<std::uint32_t> {
    static constexpr auto name = "resting", unit = "";
};
/// Where it sleeps.
struct HeldRow {
    Vec3 position = Vec3::Zero();
    double qx = 0, qy = 0, qz = 0, qw = 0, held = 0;
};
struct HeldPose : State<HeldRow> {
    static constexpr auto name = "held_pose", unit = "m";
};

} // namespace bris
