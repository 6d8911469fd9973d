#pragma once

#include "scenarios/records/test_curves.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <limits>
#include <vector>

namespace bris {

/// Stands for the test machine in findings, in place of the id of a sensor.
inline constexpr unsigned test_machine = std::numeric_limits<unsigned>::max();

/// Limits of the quality control of the channels of a test machine. A slip is not a fault: a
/// specimen may lose half of q, or 1 % of its volume, from one record to the next, but it does not
/// recover them at once.
struct MachineLimits {
    double largest_strain = 0.5; ///< axial
    /// Largest q relative to the confining pressure; 30 is a friction angle of 70 degrees. The
    /// smallest is -1: below it the rocks would be in tension.
    double largest_q = 30;
    /// Smallest median of q beyond 0.2 % of axial strain, relative to the confining pressure.
    double smallest_q = 0.02;
    /// Usual secant modulus at half of the largest q, relative to the confining pressure: that of
    /// ballast is some 100 to 2000; a shear wave shows 5000. Judged from this number of records on.
    double least_stiffness = 25, largest_stiffness = 1e4;
    std::size_t for_stiffness = 20;
    double compaction = 1; ///< largest, relative to axial strain: no lateral strain
    double dilation = 5;   ///< largest, relative to axial strain: a dilation angle of 46 degrees
    double first_volume = 1e-3; ///< allowance for membrane and platens, added to these two limits
    double largest_ring = 10;   ///< m, radius
    double ring_strain = 0.5;   ///< largest relative change of a ring radius
    /// Number of successive impossible samples from which the whole channel is refused; it is also
    /// refused if more than half of its samples are impossible.
    std::size_t long_run = 10;
    /// Samples of equal value count as stuck if there are at least this many and they extend over
    /// at least the following axial strain.
    std::size_t same_samples = 5;
    double stuck_q = 1e-3, stuck_volume = 5e-3;
};

/// Checks the measurements of a test machine so far, in order of axial strain, and returns the
/// findings. Removes (NaN) impossible samples, samples far from both neighbours, all but the first
/// of stuck samples, and whole channels with a wrong unit or sign. The last sample has only one
/// neighbour and may be a slip, so its tolerance is wider. A stiffness that no ballast has is
/// noted. `pressure`: confining, Pa.
std::vector<Finding> check_machine(MeasuredCurves& measured, double pressure,
                                   const MachineLimits& limits = {});

} // namespace bris
