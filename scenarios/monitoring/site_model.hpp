#pragma once

#include "engine/estimation/kalman.hpp"
#include "engine/estimation/pooled_variance.hpp"
#include "scenarios/monitoring/passage_cause.hpp"

#include <string>
#include <utility>
#include <vector>

namespace bris {

/// The features of one sensor in one passage of the baseline, in order of time; NaN: not known.
struct FeatureRow {
    PassageCause cause;
    std::vector<double> values;
};

/// What is expected of a feature in a new passage: normally distributed about `mean` with a
/// variance that is known as well as `degrees` of freedom say.
struct ExpectedFeature {
    double mean = 0;
    double variance = 0; ///< of passages, between sessions, too
    double of_mean = 0;  ///< variance of the mean of the baseline, over that of passages
    double degrees = 0;
    bool is_known() const { return degrees > 0; }
    double deviation() const; ///< of a passage from the mean
};

/// Passages of a condition that a baseline needs.
inline constexpr std::size_t least_passages = 4;

/// What the baseline of one sensor says of the features of new passages, by least squares: a mean
/// for each condition, and a slope for each number of the cause that the passages state.
class SensorModel {
public:
    /// Why nothing can be expected under this cause: an unknown condition, too few passages in it,
    /// a number that is missing or beyond the range of the baseline; empty: it can.
    std::string impossible_because(const PassageCause& cause) const;
    /// In the order of the features. Throws InputError where it is impossible.
    std::vector<ExpectedFeature> expected(const PassageCause& cause) const;
    /// The same in the condition with most passages, at the mean of the numbers; empty: none.
    std::vector<ExpectedFeature> typical() const;
    /// Of the baseline.
    std::size_t passages() const { return passages_; }
    std::size_t sessions() const { return sessions_; }
    /// Correlation of successive passages, estimated from all sensors of the site.
    double serial() const { return serial_; }
    /// Variance between sessions over that within; 0: one session.
    double between() const { return between_; }
    /// Residuals of a feature, in standard deviations, in order; NaN: not known.
    std::vector<double> residuals(std::size_t feature) const;

private:
    friend class SiteModel;
    struct Condition {
        std::string name;
        std::vector<std::size_t> rows;
        double of_mean = 0; // variance of a mean of its passages, over that of a passage
        std::vector<double> means;
        std::vector<EstimatedVariance> scatter; // of each feature
    };
    struct Number {
        std::string name;
        double low, high;
        std::vector<double> means; // of each condition
    };
    const Condition* condition(const PassageCause& cause) const;
    std::vector<ExpectedFeature> expected(const Condition& of, const Vector& away) const;

    std::size_t passages_ = 0, sessions_ = 0;
    double serial_ = 0, between_ = 0;
    std::vector<Condition> conditions_;
    std::vector<Number> numbers_;
    Matrix slopes_;                              // a row for each number, a column for each feature
    Matrix inverse_;                             // of the squares of the numbers
    std::vector<std::vector<double>> residuals_; // of each row
};

/// The models of all sensors of a site; `rows` of each sensor. The scatter between passages is that
/// within a condition, pooled over sensors, conditions and features of a family as far as they
/// agree. Successive passages correlate: the correlation is estimated from all residuals together
/// with a prior, and corrects variances and degrees of freedom. Sessions that are stated add their
/// own scatter.
std::vector<SensorModel> site_models(const std::vector<std::vector<FeatureRow>>& rows,
                                     const std::vector<unsigned>& families);

} // namespace bris
