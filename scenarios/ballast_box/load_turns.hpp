#pragma once

#include "scenarios/ballast_box/train.hpp"
#include "systems/loads/load.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// The extremes of the force (N, downwards) of the rails on a whole tie while a train passes
/// slowly, in their order: `dead_load` (N, of rails and fastenings), then peaks and valleys in
/// turn, and `dead_load` at the end. Axles less than about 2 m apart make one peak.
/// Extremes that differ by less than 5 % of the highest peak are left out. Where the rails would
/// lift the tie, the force is 0.
std::vector<double> load_turns(const Train& train, const RailOnTies& rails, double dead_load);

/// Load cycles of these extremes: one for each peak.
inline std::size_t cycles_of(const std::vector<double>& turns) { return (turns.size() - 1) / 2; }

/// A force that goes through these extremes one after the other, each within `interval` (s) by half
/// a cosine wave, from time 0 on.
LoadHistory load_through(const std::vector<double>& turns, double interval);

} // namespace bris
