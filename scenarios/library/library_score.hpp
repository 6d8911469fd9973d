#pragma once

#include "scenarios/library/library_prediction.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// What a prediction is scored on: curves over a part of the strains beyond those learned from
/// (near: to half of the last strain; all: to the last strain; far: the second half), and the
/// profile of the rings at the last strain.
enum class Scored : std::size_t {
    q_near,
    q_all,
    q_far,
    smoothed_q_near,
    smoothed_q_all,
    smoothed_q_far,
    volume_near,
    volume_all,
    rings_last,
    count
};
inline constexpr std::size_t scored_count = static_cast<std::size_t>(Scored::count);
/// Name of a scored quantity, with its strains in per cent, as "q_1_to_4_percent".
std::string name_of(Scored scored, double learned_strain, double last_strain);

/// Score of one quantity for one specimen. Errors are root mean squares, of q in Pa.
struct QuantityScore {
    double error = 0;  ///< of the prediction's mean
    double prior = 0;  ///< of the mean of the library, without measurements
    double single = 0; ///< mean over the errors of the single specimens of the library
    double inside = 0; ///< share of the numbers that lie in the 90 % band
    /// Mean continuous ranked probability score of ln q (volumetric and radial strain as they are).
    double crps = 0, prior_crps = 0;
};

/// Scores of the prediction of one specimen, which the library does not contain.
struct SpecimenScore {
    std::array<QuantityScore, scored_count> of = {};
    double friction = 0, learned_friction = 0; ///< logarithms
    double friction_band = 0;                  ///< half width of the 90 % band of the logarithm
    bool friction_is_inside() const {
        return std::abs(learned_friction - friction) <= friction_band;
    }
    double stiffness = 0, learned_stiffness = 0; ///< logarithms
    double distance = 0;                         ///< of its measurements (LibraryPrediction)
    /// By strain: errors of ln q and of volumetric strain, of the prediction and of the prior.
    std::vector<double> q, prior_q, volume, prior_volume;
    /// Probabilities of the measured smoothed q in its predictive distribution, by strain beyond
    /// those learned from: uniform in [0, 1] if the prediction is calibrated.
    std::vector<double> probabilities;
};

/// How specimens are scored.
struct Scoring {
    LibraryObservations observed;
    std::size_t measured_at = 0, predicted_at = 0; ///< indices of pressures
    bool sham = false; ///< measurements of another specimen: must not improve anything
    unsigned threads = 1;
};

/// Scores each specimen of a library by the prediction from all others (leave-one-out).
std::vector<SpecimenScore> scores_within(const SpecimenLibrary& library, const Scoring& scoring);
/// Scores specimens that are not in the library. Both must have the same pressures, strains and
/// rings, and the same sensor rocks if these are observed; throws InputError otherwise.
std::vector<SpecimenScore> scores_outside(const SpecimenLibrary& library,
                                          const SpecimenLibrary& truths, const Scoring& scoring);

/// A geometric mean of ratios with its 95 % interval from 2 000 bootstrap samples of the specimens.
struct RatioInterval {
    double mean = 0, low = 0, high = 0;
};
/// Throws InputError without numbers.
RatioInterval geometric_mean(std::span<const double> ratios, std::uint64_t seed);

} // namespace bris
