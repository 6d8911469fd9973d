#pragma once

#include "engine/io/series.hpp"

#include <vector>

namespace bris {

/// Columns of the samples that a loading takes.
std::vector<RunFile::Column> cycle_columns();

/// Response of one tie in one load cycle.
struct CycleResponse {
    double settlement = 0; ///< m, at the end of the cycle, since the loading began
    double resilient = 0;  ///< m, from the lowest position to the end of the cycle
    /// m, parts of the resilient deflection that the subgrade and the elastic contacts of the
    /// ballast give back; the rest is sliding between rocks. By virtual work the deflection times
    /// the mean of the forces that carry the tie at both times is the sum of the mean forces of all
    /// springs times their changes of length, which for linear springs is the energy that they give
    /// back. Of a model with one tie, and without the weight of the ballast, some 2 % of the load.
    double of_subgrade = 0, of_contacts = 0;
    double loop_area = 0; ///< J, work that the load has done on the tie over the cycle
    /// N/m, range of the load over the range of the deflection.
    double stiffness = 0;
};

/// The complete cycles of a series, of the tie whose load is least at the ends of the cycles
/// (number 1) or of the other one (number 2, whose cycles end at its peak load: the resilient
/// deflection is then the negative one).
std::vector<CycleResponse> cycle_responses(const Series& samples, int tie);

/// A law of settlement fitted by least squares to the last decade of cycles N.
struct SettlementFit {
    double slope = 0;     ///< m per unit of ln N of the logarithmic law, exponent of the power law
    double intercept = 0; ///< m, settlement at N = 1 that the law gives
    double residual = 0;  ///< m, root mean square of the differences
};
/// s = a + b ln N.
SettlementFit fit_logarithmic(const std::vector<CycleResponse>& cycles);
/// s = a N^b, fitted to ln s. NaN if the settlement is not above 0 in the last decade.
SettlementFit fit_power(const std::vector<CycleResponse>& cycles);

} // namespace bris
