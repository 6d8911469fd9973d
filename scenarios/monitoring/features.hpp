#pragma once

#include "engine/signal/autoregression.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <string_view>
#include <vector>

namespace bris {

/// What a feature tells of.
enum class FeatureKind { level, spectrum, motion };

/// A number by which a passage is judged: a logarithm, so that a change is a factor.
struct Feature {
    std::string_view name;
    std::string_view meaning; ///< as the page calls it
    FeatureKind kind;
    /// Whether it needs the axes of the baseline; others do not change if a sensor is turned.
    bool by_axis;
    unsigned family; ///< those of one family may have similar scatter (pooled_variances)
    double factor;   ///< exp(factor * difference) is a ratio of root mean squares; 0: it is none
    bool only_above; ///< whether only a larger value is a change
};

/// All features: levels (ln of root mean squares) of the vertical, of three axes together and of
/// both
/// horizontals; shares of bands of an octave in the power of three axes; distance to the
/// baseline's autoregressive model (ln of ln of the ratio of residual variances, Itakura 1975, IEEE
/// Trans. ASSP 23:67), level of its residuals, first reflection coefficients (inverse hyperbolic
/// tangent); levels of the angular rates. The first one is the level of the vertical.
const std::vector<Feature>& all_features();

/// The features of one passage in the order of all_features(); NaN: not recorded, or not known.
/// `vibration`: of the recording, whose vertical is another quantity if it is; `ranges`: of its
/// samples. Those that need a model are NaN.
std::vector<double> features_of(const Recording& recording, const Vibration& vibration,
                                const std::vector<SampleRange>& ranges);
/// Adds those by the baseline's model. `runs`: the vibration in the ranges; `usual`: samples of a
/// passage of the baseline, since a short passage is farther from any model by its errors alone.
void add_model_features(std::vector<double>& features, const ArModel& model, Runs runs,
                        double usual);

} // namespace bris
