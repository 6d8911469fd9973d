#pragma once

#include "scenarios/monitoring/site_model.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// Two-sided probability of a value t standard deviations from the mean of a baseline: by Student's
/// t, and at least that of tails as heavy as those of passages, taken as Student's t with five
/// degrees of freedom (two values in a hundred lie beyond 2.6 deviations, two in ten thousand
/// beyond 6). The mean of `values` passages has their excess of kurtosis over that number, which is
/// that of 4 + `values` degrees of freedom.
double p_of_deviation(double t, double degrees, double values = 1);
/// The t beyond which this probability lies.
double deviation_of_p(double p, double degrees, double values = 1);

/// Shares of the allowed false alarms of the features of one of `sensors` sensors: half for the
/// first feature, the level of the vertical, and the rest equally for all others that are judged;
/// 0: it is not judged.
std::vector<double> shares_of(const std::vector<bool>& is_judged, std::size_t sensors);

/// Which hypotheses are rejected so that the probability of any wrong one is at most
/// `false_alarms`, weighted by `shares` (Holm 1979, Scand. J. Stat. 6:65). NaN: not tested.
std::vector<bool> rejected(const std::vector<double>& p, const std::vector<double>& shares,
                           double false_alarms);

/// The smallest change of a feature that is seen in 90 % of passages, if a deviation of
/// probability `p` is seen: of its unit, in one direction. `values`: passages in a mean.
double seen_in_90_per_cent(const ExpectedFeature& expected, double p, double values = 1);

/// Several passages beside their baseline, by deviations in standard deviations of a passage, in
/// order; NaN: not judged.
struct Trend {
    std::size_t passages = 0;
    double mean = 0;     ///< deviations
    double slope = 0;    ///< deviations a passage, from the baseline on
    double variance = 1; ///< of the mean, over that of a passage
    double p_mean = 1, p_slope = 1;
    bool is_slope = false; ///< a straight line from the baseline fits better than a step
};
/// `expected`: of these passages, on average; `serial`: correlation of successive passages;
/// `between`: variance between sessions over that within, of which they are counted as one.
Trend trend_of(const std::vector<double>& deviations, const ExpectedFeature& expected,
               double serial, double between);

/// One of the tests of several passages of a feature: of their mean, of a straight line from the
/// baseline on, of the means of the last 2, 4, 8 ... passages, and of each passage by itself. Each
/// kind has a quarter of the feature's share of the false alarms.
struct TestOfRun {
    enum class Kind { mean, slope, recent, passage };
    Kind kind;
    std::size_t passage = 0; ///< that is tested, or the first one of the last
    double p, share;
    Trend trend; ///< of mean, slope and recent
};
/// `deviations`, `expected`, `serial` and `between`: as trend_of has them; `p`: of each passage by
/// itself, NaN: not judged; `only_above`: what is below is no change; `share`: of the feature.
std::vector<TestOfRun> tests_of_run(const std::vector<double>& deviations,
                                    const std::vector<double>& p, const ExpectedFeature& expected,
                                    double serial, double between, bool only_above, double share);

} // namespace bris
