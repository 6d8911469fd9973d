#pragma once

#include "scenarios/records/logged_axes.hpp"

#include <string>
#include <vector>

namespace bris {

/// The vector in SI units, and whether it contains gravity.
struct ScaledVector {
    std::array<std::optional<LoggerColumn>, 3> axes = {};
    bool has_gravity = true;
    bool is_known = true; ///< false: rates whose unit nothing tells, which are left out
};

/// The unit of a vector: as stated, as the maker of the file uses it, or for accelerations the only
/// one in which the median at rest is gravity. Says in the notes what was assumed or does not fit.
/// `sensor`: of each sampled row. Throws InputError if an acceleration has no unit, if units are
/// unknown or differ, or if only another unit than the stated one would make the median gravity.
ScaledVector scaled(const LoggedVector& vector, const LoggerTable& table,
                    const std::vector<SampledColumn>& sample, const std::vector<double>& sensor,
                    std::vector<std::string>& notes);

} // namespace bris
