#pragma once

#include "engine/signal/spectrum.hpp"
#include "scenarios/network/network_simulation.hpp"

#include <limits>
#include <vector>

namespace bris {

/// What one strategy of sampling achieves on the truth. Per rock: means over the rocks.
struct StrategyResult {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    Strategy strategy = Strategy::continuous;
    PacketBalance packets;
    double bytes_per_day = 0;  ///< B, received by the cloud from all rocks
    double energy_per_day = 0; ///< J, of a rock
    double lifetime = 0;       ///< s, of a rock: until its battery was empty, or extrapolated
    double recorded_share = 0; ///< of the time under trains, received by the cloud
    /// Sum of |received - true| over the bins from 1 to 200 Hz over the sum of true: of the spectra
    /// of all trains, mean over the rocks that were received.
    double spectrum_error = unknown;
    double alarm_delay = unknown; ///< s, from the first train after the change to a warning of it
    std::size_t warnings = 0, false_warnings = 0; ///< received; of trains before the change
    double host_least_charge = 0;                 ///< J, at the end
    std::vector<AppliedChange> changes = {};
    Spectrum true_spectrum = {}, received_spectrum = {}; ///< of the first rock
};

StrategyResult result_of(const NetworkSimulation& simulation, const NetworkSettings& settings,
                         const Truth& truth);

/// Lifetime (s) of a duty-cycled rock whose link is always up and loses nothing: battery over the
/// mean power of sleep, sampling, sending and contacts.
double duty_cycle_lifetime(const NetworkSettings& settings);

} // namespace bris
