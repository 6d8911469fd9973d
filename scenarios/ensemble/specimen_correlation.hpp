#pragma once

#include "engine/estimation/parameter_estimate.hpp"

namespace bris {

/// A strong specimen also dilates and widens more: among eleven specimens of friction 0.7 ln q and
/// dilation have a correlation of 0.6 to 0.9, and each persists with about this memory
/// (tests/performance/packing_campaign). The memory is in units of ln strain.
inline constexpr SpecimenCorrelation specimen_correlation{.memory = 4, .channels = 0.6};
inline constexpr double no_stress = 1e3; ///< Pa, below which the logarithm of q is meaningless

} // namespace bris
