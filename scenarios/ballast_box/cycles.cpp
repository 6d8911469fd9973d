#include "scenarios/ballast_box/cycles.hpp"

#include "engine/estimation/linear_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

std::vector<CycleResponse> cycle_responses(const SeriesOf<CycleSample>& samples, int tie) {
    using S = CycleSample;
    const auto &cycle = samples[&S::cycle], &load = samples[tie == 1 ? &S::load_1 : &S::load_2],
               &deflection = samples[tie == 1 ? &S::deflection_1 : &S::deflection_2],
               &carried = samples[&S::tie_support], &subgrade = samples[&S::subgrade_energy],
               &contacts = samples[&S::contact_energy];
    std::vector<CycleResponse> all;
    std::size_t lowest_tie = 0; // sample
    double last_load = 0, last_deflection = 0;
    CycleResponse now;
    double highest = -std::numeric_limits<double>::infinity(),
           lowest = std::numeric_limits<double>::infinity(), most_load = 0,
           least_load = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < cycle.size(); ++k) {
        if (k > 0) now.loop_area += 0.5 * (load[k] + last_load) * (deflection[k] - last_deflection);
        last_load = load[k];
        last_deflection = deflection[k];
        if (deflection[k] > highest) lowest_tie = k;
        highest = std::max(highest, deflection[k]);
        lowest = std::min(lowest, deflection[k]);
        most_load = std::max(most_load, load[k]);
        least_load = std::min(least_load, load[k]);
        if (cycle[k] < static_cast<double>(all.size() + 1) - 1e-6) continue;
        now.settlement = deflection[k];
        now.resilient = highest - deflection[k];
        const double mean = 0.5 * (carried[lowest_tie] + carried[k]);
        now.of_subgrade = (subgrade[lowest_tie] - subgrade[k]) / mean;
        now.of_contacts = (contacts[lowest_tie] - contacts[k]) / mean;
        // the unloading half, without the plastic part of the loading half
        now.stiffness = (most_load - least_load) /
                        (tie == 1 ? now.resilient : std::max(highest - lowest, 1e-300));
        all.push_back(now);
        now = {};
        highest = -std::numeric_limits<double>::infinity();
        lowest = std::numeric_limits<double>::infinity();
        most_load = 0;
        least_load = std::numeric_limits<double>::infinity();
    }
    return all;
}

namespace {

/// Fits y(s) = a + b ln N to the last decade; `back` turns a value of the line into a settlement.
template <class Scale, class Back>
SettlementFit fit_last_decade(const std::vector<CycleResponse>& cycles, Scale&& scale,
                              Back&& back) {
    const std::size_t last = cycles.size(), first = (last + 9) / 10;
    std::vector<double> x, y;
    for (std::size_t n = first; n <= last; ++n) {
        x.push_back(std::log(static_cast<double>(n)));
        y.push_back(scale(cycles[n - 1].settlement));
    }
    const LinearFit line = fit_line(x, y, x.front(), x.back());
    SettlementFit fit{line.slope, back(line.intercept), 0};
    for (std::size_t n = first; n <= last; ++n) {
        const double off =
            back(line.intercept + line.slope * x[n - first]) - cycles[n - 1].settlement;
        fit.residual += off * off / static_cast<double>(x.size());
    }
    fit.residual = std::sqrt(fit.residual);
    return fit;
}

} // namespace

SettlementFit fit_logarithmic(const std::vector<CycleResponse>& cycles) {
    const auto same = [](double s) { return s; };
    return fit_last_decade(cycles, same, same);
}

SettlementFit fit_power(const std::vector<CycleResponse>& cycles) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t n = (cycles.size() + 9) / 10; n <= cycles.size(); ++n)
        if (!(cycles[n - 1].settlement > 0)) return {unknown, unknown, unknown};
    return fit_last_decade(
        cycles, [](double s) { return std::log(s); }, [](double y) { return std::exp(y); });
}

} // namespace bris
