#include "engine/signal/median.hpp"
#include "scenarios/recordings/inspection.hpp"
#include "scenarios/recordings/machine_quality_control.hpp"
#include "scenarios/recordings/synchronise.hpp"

#include <cmath>

namespace bris {

namespace {

/// The finite numbers of a series.
std::vector<double> finite(const std::vector<double>& values) {
    std::vector<double> some;
    std::ranges::copy_if(values, std::back_inserter(some),
                         [](double x) { return std::isfinite(x); });
    return some;
}

constexpr double slack = 1e-3; // strain from which ratios mean something

/// Why these strains, from the first sample to the last, are not those of a test that begins
/// without strain and compresses further and further; "".
std::string reason_against_course(const std::vector<double>& strains) {
    constexpr std::size_t fewest = 10;
    if (strains.size() < fewest) return {};
    const auto moved = std::ranges::find_if(strains, [&](double e) { return e != strains[0]; });
    if (const auto still = moved - strains.begin(); still >= 3 && strains[0] > slack)
        return fmt::format(
            "expected 0 before the test, found {:.4g} in the first {} samples: is it "
            "shifted?",
            strains[0], still);
    std::vector<double> sorted = strains;
    std::ranges::sort(sorted);
    const double high = sorted[sorted.size() * 9 / 10],
                 late = median(
                     std::vector(strains.end() - static_cast<std::ptrdiff_t>(strains.size() / 10),
                                 strains.end()));
    if (!(high > slack) || late > 0.5 * high) return {};
    return fmt::format("expected strains that grow, found more than {:.4g} in a tenth of the "
                       "samples, but a median of {:.4g} in the last tenth",
                       high, late);
}

/// A factor between two strains that a wrong unit explains; "".
std::string hint_at_per_cent(double factor) {
    return factor > 50 && factor < 200 ? ": is it in per cent?" : "";
}

class StrainComparison {
public:
    StrainComparison(const std::vector<TriaxialPoint>& measured, const MachineClock& clock)
        : clock_(clock) {
        for (const TriaxialPoint& p : measured)
            if (std::isfinite(p.axial_strain)) largest_ = std::max(largest_, p.axial_strain);
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
        const auto strains = finite(r.strain);
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

bool has_possible_strain(const Inspection& at) {
    const auto strains = finite(at.recording.strain);
    if (strains.empty()) return true;
    const double most = at.limits.largest_strain;
    const auto outside = [&](double e) { return !(e >= -0.1 * most && e <= most); };
    const auto wrong = std::ranges::count_if(strains, outside);
    const auto negative = std::ranges::count_if(strains, [](double e) { return e < -1e-3; });
    if (2 * static_cast<std::size_t>(negative) > strains.size()) {
        at.refuse("strain", fmt::format("expected positive values in compression, found {} of {} "
                                        "negative: is its sign reversed?",
                                        negative, strains.size()));
        return false;
    }
    if (wrong == 0) {
        const std::string reason = reason_against_course(strains);
        if (!reason.empty()) at.refuse("strain", reason);
        return reason.empty();
    }
    const double worst =
        *std::ranges::max_element(strains, {}, [](double e) { return std::abs(e); });
    at.refuse("strain", fmt::format("expected {:g} to {:g}, which a test can reach, found {} of {} "
                                    "samples outside, up to {:.4g}{}",
                                    -0.1 * most, most, wrong, strains.size(), worst,
                                    worst > 0 && worst < 100 ? ": is it in per cent?" : ""));
    return false;
}

void compare_strain(const std::vector<Recording>& recordings,
                    const std::vector<TriaxialPoint>& measured, const MachineClock& clock,
                    std::vector<Finding>& findings) {
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
