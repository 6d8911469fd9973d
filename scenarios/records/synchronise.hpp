#pragma once

#include "scenarios/sensors/quality_control.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Axial strain of a test according to the machine, by its time t (s) and by its count of load
/// cycles.
struct MachineClock {
    std::map<double, double> by_time, by_phase;
};

/// Strain at a time or phase, interpolated linearly. 0 before the first entry if the test is at
/// rest there (strain 0 or below); NaN where it is unknown.
double strain_between(const std::map<double, double>& strain_at, double where);

/// Why phases cannot be counts of load cycles: they decrease. Nothing: they can.
std::optional<std::string> reason_against_phases(const std::vector<double>& phases);

/// Assigns the strain of the machine to recordings without strain: at the same phase, otherwise at
/// their t minus the clock_offset of their metadata. Refuses recordings with neither, with
/// decreasing phases, with clocks outside the test, and with clocks so uncertain that within three
/// standard deviations the test advances by more than `interval` of axial strain. Returns the
/// findings.
std::vector<Finding> synchronise(std::vector<Recording>& recordings, const MachineClock& clock,
                                 double interval);

} // namespace bris
