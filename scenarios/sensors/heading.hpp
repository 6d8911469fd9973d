#pragma once

#include "scenarios/sensors/recording.hpp"

#include <string>

namespace bris {

/// Yaw of a rock since the start of a test, from the magnetic field of the earth.
struct Heading {
    std::string unobservable_because; ///< why yaw cannot be observed; empty: it can
    double field = 0;                 ///< T, median magnitude
    /// Scatter of the magnitude (relative) and of the dip (rad): nine tenths of the samples are
    /// closer to the median than this.
    double wander = 0, dip_wander = 0;
    double dip = 0;         ///< rad, below the horizontal
    double turn = 0;        ///< rad, rotation about the vertical at the last sample
    double by_attitude = 0; ///< the same from the attitude channel; NaN: there is none
    double deviation = 0;   ///< rad, standard deviation of turn
    bool observable() const { return unobservable_because.empty(); }
};

/// Estimates the yaw of a rock from its magnetometer. Needs the channels field and force; the
/// specific force is taken as the vertical, so the rock must move slowly. Yaw is observable where
/// the field is that of the earth (20 to 70 uT) with a horizontal component of at least 5 uT, and
/// steady: nine tenths of the samples within 5 % of the median magnitude and within 5 degrees of
/// the median dip. The deviation combines noise, the bias (which rotates with the rock), the
/// scatter of the field (as if it were all horizontal), and the error of the tilt (times the
/// tangent of the dip). Iron that rotates the field without changing its magnitude and dip cannot
/// be distinguished from yaw.
Heading heading_of(const Recording& recording);

} // namespace bris
