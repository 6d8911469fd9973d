#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

struct ConfidenceInterval {
    double low = 0, high = 0;
};

/// Exact interval of Clopper and Pearson (1934) that contains the probability of a success with at
/// least this `confidence`, in (0, 1). Throws InputError if there are more successes than trials.
ConfidenceInterval binomial_interval(std::size_t successes, std::size_t trials,
                                     double confidence = 0.95);

/// One point of a receiver operating characteristic: the shares of scores above a threshold.
struct RocPoint {
    double threshold, false_alarms, detections;
};

/// The characteristic of a detector by its scores without and with the change to be detected, from
/// the highest threshold (no alarms) to the lowest (all): one point for each different score.
/// Throws InputError if one of the two is empty or contains a NaN.
std::vector<RocPoint> roc_curve(std::span<const double> unchanged, std::span<const double> changed);

/// Area under the characteristic: the probability that a changed score exceeds an unchanged one,
/// equal scores counting half. Throws InputError as roc_curve.
double area_under_roc(std::span<const double> unchanged, std::span<const double> changed);

/// Percentile interval of that area over `draws` bootstrap samples of both groups (Efron 1979); the
/// scores must be independent. It has no width where the groups do not overlap.
ConfidenceInterval bootstrap_area_under_roc(std::span<const double> unchanged,
                                            std::span<const double> changed, double confidence,
                                            std::size_t draws, std::uint64_t seed);

} // namespace bris
