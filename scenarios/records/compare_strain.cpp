#include "scenarios/records/compare_strain.hpp"

#include "engine/signal/median.hpp"
#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/sensors/inspection.hpp"

#include <cmath>

namespace bris {

namespace {

constexpr double slack = 1e-3; // strain from which ratios mean something

/// A factor between two strains that a wrong unit explains; "".
std::string hint_at_per_cent(double factor) {
    return factor > 50 && factor < 200 ? ": is it in per cent?" : "";
}

class StrainComparison {
public:
    StrainComparison(const MeasuredCurves& measured, const MachineClock& clock) : clock_(clock) {
        for (const double strain : measured[quantity::axial_strain])
            if (std::isfinite(strain)) largest_ = std::max(largest_, strain);
    }

    /// The reason against the strain of a recording; "".
    std::string reason_against(const Recording& r) const {
        const std::string of_ends = reason_by_ends(r);
        return of_ends.empty() ? reason_by_time(r) : of_ends;
    }

private:
    /// Machine or sensor may have failed during the test, so only a wrong unit is found in this
    /// way.
    std::string reason_by_ends(const Recording& r) const {
        const auto strains = finite_of(r.strain);
        if (strains.empty() || largest_ < slack) return {};
        const double found = std::ranges::max(strains);
        if (found < 50 * largest_ && 50 * found > largest_) return {};
        return fmt::format("the records reach {:.4g}, but those of the machine end at {:.4g}{}",
                           found, largest_, hint_at_per_cent(found / largest_));
    }

    /// Where both have a clock, the strains agree at the same time.
    std::string reason_by_time(const Recording& r) const {
        if (clock_.by_time.size() < 2 || r.strain.size() != r.size()) return {};
        std::vector<double> ratios;
        const auto advance =
            [&](double t) { // how far the strain advances while the clock is unsure
                const double unsure = 3 * r.info.clock_offset_deviation;
                const double before = strain_between(clock_.by_time, t - unsure),
                             after = strain_between(clock_.by_time, t + unsure);
                return after - before; // NaN at the ends
            };
        for (std::size_t k = 0; k < r.size(); ++k) {
            const double t = r.time[k] - r.info.clock_offset,
                         of_machine = strain_between(clock_.by_time, t);
            // far enough into the test for a ratio that the clocks cannot explain
            if (of_machine > slack && advance(t) < 0.5 * of_machine && std::isfinite(r.strain[k]))
                ratios.push_back(r.strain[k] / of_machine);
        }
        if (ratios.size() < 10) return {};
        const double ratio = median(ratios);
        if (ratio > 0.5 && ratio < 2) return {};
        return fmt::format("at the same time the records have {:.4g} times the strain of the "
                           "machine{}",
                           ratio, hint_at_per_cent(ratio > 0 ? std::max(ratio, 1 / ratio) : 0));
    }

    const MachineClock& clock_;
    double largest_ = 0;
};

} // namespace

void compare_strain(const std::vector<Recording>& recordings, const MeasuredCurves& measured,
                    const MachineClock& clock, std::vector<Finding>& findings) {
    const auto is_refused = [&](unsigned sensor, const std::string& check) {
        return std::ranges::any_of(findings, [&](const Finding& f) {
            return f.sensor == sensor && f.check == check && f.kind == Finding::Kind::refusal;
        });
    };
    if (is_refused(test_machine, "axial_strain")) return; // nothing to compare with
    const StrainComparison comparison(measured, clock);
    for (const Recording& r : recordings) {
        if (is_refused(r.info.id, "strain") || is_refused(r.info.id, "clock")) continue;
        if (const auto reason = comparison.reason_against(r); !reason.empty())
            findings.push_back({Finding::Kind::refusal, r.info.id, "strain", reason});
    }
}

} // namespace bris
