#include "scenarios/track/settling_track.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t stream = 671; // of random numbers

/// Until a good track has settled by `until` (m).
void settle(TrackStretch& stretch, const SettlingTrack& track, const std::vector<double>& rates,
            double until) {
    constexpr double most_blocks = 20'000;
    const double step = track.block * stretch.even_load() / track.stretch.tie_support;
    require(until <= most_blocks * step,
            fmt::format("track: expected a settlement of at most {:.3g} mm, {:g} blocks, found "
                        "{:.3g} mm",
                        1e3 * most_blocks * step, most_blocks, 1e3 * until));
    while (until - stretch.settled() > 1e-12) {
        double fastest = 1;
        std::vector<double> by;
        for (std::size_t i = 0; i < rates.size(); ++i) {
            const double load = stretch.load(i) / stretch.even_load();
            by.push_back(rates[i] * std::pow(load, track.law.exponent));
            fastest = std::max(fastest, by.back());
        }
        const double good = std::min(step / fastest, until - stretch.settled());
        for (double& tie : by) tie *= good;
        stretch.settle(by, good);
    }
}

} // namespace

std::vector<double> SettlementLaw::rates(const StretchSettings& stretch,
                                         std::uint64_t number) const {
    Random random(number, stream);
    std::vector<double> of_ties;
    for (std::size_t i = 0; i < stretch.ties; ++i)
        of_ties.push_back((stretch.is_mud(i) ? ratio : 1) * std::exp(scatter * random.normal()));
    return of_ties;
}

std::vector<StretchState> settle_track(const SettlingTrack& track,
                                       const std::vector<double>& settlements,
                                       std::uint64_t number) {
    require(std::ranges::is_sorted(settlements), "track: expected ascending settlements");
    TrackStretch stretch(track.stretch);
    const std::vector<double> rates = track.law.rates(track.stretch, number);
    std::vector<StretchState> states;
    double tamped = 0; // m, when it was last
    for (const double settled : settlements) {
        while (track.tamping > 0 && tamped + track.tamping < settled) {
            tamped += track.tamping;
            settle(stretch, track, rates, tamped);
            stretch.tamp();
        }
        settle(stretch, track, rates, settled);
        states.push_back(stretch.state());
    }
    return states;
}

} // namespace bris
