#pragma once

#include "engine/io/series.hpp"

#include <array>
#include <vector>

namespace bris {

/// A sample of a loading. The numbers of ties are those of cycle_responses().
struct CycleSample {
    double cycle, time, load_1, load_2, deflection_1, deflection_2, bladder_pressure,
        bladder_displacement, subgrade_settlement, tie_load, tie_support, subgrade_force,
        unbalanced_ratio, subgrade_energy, contact_energy;
    static constexpr auto columns() {
        using S = CycleSample;
        return std::array{Sampled{&S::cycle, "cycle", ""},
                          Sampled{&S::time, "time", "s"},
                          Sampled{&S::load_1, "load_1", "N"},
                          Sampled{&S::load_2, "load_2", "N"},
                          Sampled{&S::deflection_1, "deflection_1", "m"},
                          Sampled{&S::deflection_2, "deflection_2", "m"},
                          Sampled{&S::bladder_pressure, "bladder_pressure", "Pa"},
                          Sampled{&S::bladder_displacement, "bladder_displacement", "m"},
                          Sampled{&S::subgrade_settlement, "subgrade_settlement", "m"},
                          Sampled{&S::tie_load, "tie_load", "N"},
                          Sampled{&S::tie_support, "tie_support", "N"},
                          Sampled{&S::subgrade_force, "subgrade_force", "N"},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""},
                          Sampled{&S::subgrade_energy, "subgrade_energy", "J"},
                          Sampled{&S::contact_energy, "contact_energy", "J"}};
    }
};

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
std::vector<CycleResponse> cycle_responses(const SeriesOf<CycleSample>& samples, int tie);

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
