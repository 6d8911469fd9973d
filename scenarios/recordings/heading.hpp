#pragma once

#include "scenarios/recordings/recording.hpp"

#include <string>

namespace bris {

/// What the earth's field says of a rock's yaw since the beginning of a test.
struct Heading {
    std::string unobservable_because;  ///< why it says nothing; empty: it does
    double field = 0;                  ///< T, the median
    double wander = 0, dip_wander = 0; ///< of its size (share) and of its dip (rad): nine tenths of
                                       ///< the samples are nearer the median
    double dip = 0;                    ///< rad, below level
    double turn = 0;                   ///< rad, about the vertical, of the last sample
    double by_attitude = 0;            ///< the same by the channel of attitude; NaN: none
    double deviation = 0;              ///< rad, of turn
    bool observable() const { return unobservable_because.empty(); }
};

/// Needs field and force; upwards is where the force points, so the rock must move slowly. Yaw is
/// told where the field is the earth's (20 to 70 uT), 5 uT or more of it level, and steady: its
/// size within 5 %, its dip within 5 degrees. The deviation is of noise and of bias, which turns
/// with the rock, of wander, as if it were level, and of tilt (times the tangent of the dip). Iron
/// that turns the field and leaves size and dip as they are cannot be told from yaw.
Heading heading_of(const Recording& recording);

} // namespace bris
