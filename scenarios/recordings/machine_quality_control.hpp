#pragma once

#include "scenarios/recordings/quality_control.hpp"
#include "scenarios/recordings/triaxial_point.hpp"

#include <limits>
#include <vector>

namespace bris {

/// Stands in findings where a sensor has its id.
inline constexpr unsigned test_machine = std::numeric_limits<unsigned>::max();

/// What the intake of a test machine's channels looks for. A slip is no fault: a specimen loses
/// half of q or 1 % of its volume from one record to the next. It does not get them back at once,
/// though.
struct MachineLimits {
    double largest_strain = 0.5; ///< axial
    double largest_q = 30; ///< of the confining pressure: a friction angle of 70 degrees. Below -1
                           ///< rocks would pull
    double smallest_q =
        0.02;              ///< of the confining pressure, the median beyond 0.2 % of axial strain
    double compaction = 1; ///< largest, of axial strain: the sides stay where they are
    double dilation = 5;   ///< largest, likewise: a dilation angle of 46 degrees
    double first_volume = 1e-3; ///< besides: what membrane and platens take up
    double largest_ring = 10;   ///< m
    double ring_strain = 0.5;   ///< by which a ring may widen or narrow
    std::size_t long_run = 10;  ///< samples in succession that cannot be, or more than half of all,
                                ///< and the channel is wrong
    std::size_t same_samples =
        5; ///< of one value are stuck, if they last for as much axial strain as:
    double stuck_q = 1e-3, stuck_volume = 5e-3;
};

/// Looks at what a test machine measured so far, in order of axial strain, and says what is wrong.
/// Left out (NaN) are samples that cannot be, that are far from both their neighbours (the last has
/// only one, and may be a slip: it is believed more readily), and all but the first that are stuck;
/// and a whole channel that is of another unit or sign. `pressure`: confining, Pa.
std::vector<Finding> check_machine(std::vector<TriaxialPoint>& measured, double pressure,
                                   const MachineLimits& limits = {});

} // namespace bris
