#pragma once

#include "scenarios/recordings/quality_control.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// How far a test had come, as its machine tells: axial strain by its t (s), and by its count of
/// load cycles.
struct MachineClock {
    std::map<double, double> by_time, by_phase;
};

/// The strain at a time or phase, straight between those that are there. 0 before the first where
/// that is at rest; NaN where it is not known.
double strain_between(const std::map<double, double>& strain_at, double where);

/// Why phases cannot be counts of cycles: they go back. Nothing: they can.
std::optional<std::string> reason_against_phases(const std::vector<double>& phases);

/// Gives recordings without strain that of the machine: at the same phase, else at their t less the
/// clock_offset of their metadata. Refuses those that have neither, phases that go back, clocks
/// that lead nowhere into the test, and clocks that are known to no better than the time in which
/// the test goes `interval` of axial strain.
std::vector<Finding> synchronise(std::vector<Recording>& recordings, const MachineClock& clock,
                                 double interval);

} // namespace bris
