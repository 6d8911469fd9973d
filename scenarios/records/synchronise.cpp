#include "scenarios/records/synchronise.hpp"

#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace bris {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

class Synchronisation {
public:
    Synchronisation(Recording& recording, const MachineClock& clock, std::vector<Finding>& findings)
        : r_(recording), clock_(clock), findings_(findings) {}

    void find_strain(double interval) {
        if (!r_.phase.empty() && clock_.by_phase.size() > 1) return by_phase();
        if (clock_.by_time.size() > 1) return by_time(interval);
        refuse(r_.phase.empty()
                   ? "expected strain or phase in its records, or t in those of the machine, found "
                     "none"
                   : "expected strain in its records, or phase or t in those of the machine, found "
                     "none");
    }

private:
    void refuse(const std::string& text) {
        findings_.push_back({Finding::Kind::refusal, r_.info.id, "clock", text});
    }
    void note(const std::string& text) {
        findings_.push_back({Finding::Kind::note, r_.info.id, "clock", text});
    }

    void by_phase() {
        if (const auto reason = reason_against_phases(r_.phase)) return refuse(*reason);
        take(clock_.by_phase, r_.phase, "cycles", "");
    }

    void by_time(double interval) {
        std::vector<double> rates;
        for (auto at = clock_.by_time.begin(); std::next(at) != clock_.by_time.end(); ++at)
            rates.push_back((std::next(at)->second - at->second) /
                            (std::next(at)->first - at->first));
        const double unsure = 3 * r_.info.clock_offset_deviation,
                     strain = unsure * median(std::move(rates));
        if (strain > interval)
            return refuse(fmt::format(
                "clock_offset is known to {:.2g} s, during which the axial "
                "strain grows by {:.2g} %, expected at most {:.2g} % (--interval): give "
                "strain, phase or a more accurate clock_offset",
                unsure, 100 * strain, 100 * interval));
        std::vector<double> t;
        for (const double own : r_.time) t.push_back(own - r_.info.clock_offset);
        take(clock_.by_time, t, "s", ": give clock_offset");
    }

    void take(const std::map<double, double>& strain_at, const std::vector<double>& where,
              const char* unit, const char* advice) {
        std::vector<double> strain, known; // known: phase or time, which may be sampled less often
        std::size_t outside = 0;
        for (const double w : where) {
            strain.push_back(std::isfinite(w) ? strain_between(strain_at, w) : unknown);
            if (!std::isfinite(w)) continue;
            known.push_back(w);
            outside += static_cast<std::size_t>(std::isnan(strain.back()));
        }
        if (std::ranges::none_of(strain, [](double e) { return e > 0; })) {
            const auto [first, last] = known.empty() ? std::ranges::min_max_result{unknown, unknown}
                                                     : std::ranges::minmax(known);
            return refuse(fmt::format("expected records of the test, {:.4g} to {:.4g} {} by the "
                                      "machine, found {:.4g} to {:.4g}{}",
                                      strain_at.begin()->first, strain_at.rbegin()->first, unit,
                                      first, last, advice));
        }
        r_.strain = std::move(strain);
        const auto left_out = outside > 0
                                  ? fmt::format("; {} of {} samples are outside it and left out",
                                                outside, known.size())
                                  : "";
        note(fmt::format("strain is interpolated from {} of the machine{}",
                         unit == std::string("s") ? "t" : "phase", left_out));
    }

    Recording& r_;
    const MachineClock& clock_;
    std::vector<Finding>& findings_;
};

} // namespace

std::optional<std::string> reason_against_phases(const std::vector<double>& phases) {
    double last = -std::numeric_limits<double>::infinity();
    for (const double phase : phases) {
        if (phase < last)
            return fmt::format(
                "expected phases that increase over all cycles, found {:.4g} after {:.4g}{}", phase,
                last, last - phase > 0.5 ? ": count the cycles" : "");
        if (std::isfinite(phase)) last = phase;
    }
    return {};
}

double strain_between(const std::map<double, double>& strain_at, double where) {
    const auto after = strain_at.lower_bound(where);
    if (after != strain_at.end() && after->first == where) return after->second;
    if (after == strain_at.begin())
        return !strain_at.empty() && after->second <= 0
                   ? 0
                   : unknown;                     // before the test, or before its first record
    if (after == strain_at.end()) return unknown; // not yet
    const auto before = std::prev(after);
    return before->second + (after->second - before->second) * (where - before->first) /
                                (after->first - before->first);
}

std::vector<Finding> synchronise(std::vector<Recording>& recordings, const MachineClock& clock,
                                 double interval) {
    std::vector<Finding> findings;
    for (Recording& r : recordings)
        if (r.strain.empty() && r.size() > 0)
            Synchronisation(r, clock, findings).find_strain(interval);
    return findings;
}

} // namespace bris
