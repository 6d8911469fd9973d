#pragma once

#include "scenarios/ensemble/learning.hpp"

#include <cstddef>
#include <limits>
#include <string>

namespace bris {

/// The deviatoric stress of one stage of a test as model and records expect it, and whether the
/// record of this stage agrees. NaN: unknown.
struct FusedStress {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    enum class Agreement { unknown, agrees, disagrees };

    double model = unknown;      ///< Pa, of the members at the parameter estimate
    double fused = unknown;      ///< Pa, expected measurement, from the records of earlier stages
    double half_width = unknown; ///< Pa, of the band that holds it with a probability of 95 %
    double measured = unknown;   ///< Pa, at this stage
    Agreement agreement = Agreement::unknown;
    std::string reason = "q was not measured yet";
};

/// ln q of a real specimen differs from the regression of the members at `estimate` by a deviation
/// of its packing (standard deviation `specimen_scatter`, memory specimen_correlation), by what
/// the parameters are uncertain, and by its own slips, which are like the residuals of the members
/// and as correlated from stage to stage. A Kalman filter follows both from the records of all
/// stages before `stage` and predicts the record of this one; where the last records were farther
/// from their predictions than these variances say, the band is wider by that factor. Model and
/// test disagree if the measured q differs from that of the model by more than 99 % of specimens
/// do, or if it was outside its band in three successive stages. They are not compared where q is
/// below 1 kPa or was not measured.
FusedStress fused_stress(const Ensemble& members, const Gaussian& estimate,
                         const MeasuredCurves& measured, const Learning& settings,
                         std::size_t stage);

} // namespace bris
