#pragma once

#include "scenarios/monitoring/passing_pattern.hpp"

#include <span>
#include <string>

namespace bris {

/// How well the vertical acceleration of a rock fits a passing train.
struct TrainFit {
    double speed = 0;    ///< m/s, at which it fits best
    double goodness = 0; ///< share of the power up to `band` that the train explains, 0 to 1
    double band = 0;     ///< Hz, from the wave number of the rails and the speed
    /// Probability that a train that is not this one fits as well: with axles in random order and
    /// at random distances, or with the same spectrum and random phases, whichever is greater.
    double p_value = 1;
    std::string refused_because = {}; ///< empty: the recording is one of this train
};

/// Tests whether an acceleration (m/s2, downwards, `rate` Hz) is that of a rock under this train.
///
/// The pattern of the train is the second derivative of its load on the tie, above `lowest` (Hz).
/// It is matched to the series at all lags from half a second before it to half a second after its
/// end, and at speeds within 5 % of the stated one. The same is done with up to 199 trains of
/// shuffled axles (their distances also stretched by a factor of up to 2, because few axles have
/// few orders) and up to 199 patterns of shuffled phases, which have the spectrum of the train, so
/// that noise of any colour fits them as well. The recording is refused
/// - unless at most one in a hundred of each fits as well as the train does (the p-value follows
///   Besag and Clifford 1991: the trial ends once ten fit as well);
/// - if the train explains less than a quarter of the power in its band, as when a longer train
///   passes that contains this one;
/// - if a third of the train is seen with less than half or more than twice the factor of the whole
///   by three standard deviations, as when the train stops or is shorter;
/// - if more is left of the series before and after the train than within it, as when another
///   train goes on. Random numbers are the same in every call.
TrainFit fit_train(std::span<const double> acceleration, double rate, const PassingTrain& passing,
                   double lowest);

} // namespace bris
