#pragma once

#include "scenarios/records/synchronise.hpp"
#include "scenarios/records/test_curves.hpp"

#include <vector>

namespace bris {

/// Compares the strain that sensors record with that of the test machine, which has been checked.
/// At the same time (where the machine has a clock) both must agree within a factor of 2; without a
/// clock a recording must not reach 50 times the strain of the machine, whose records may end
/// earlier. Adds a refusal for each sensor that does not agree.
void compare_strain(const std::vector<Recording>& recordings, const MeasuredCurves& measured,
                    const MachineClock& clock, std::vector<Finding>& findings);

} // namespace bris
