#include "scenarios/monitoring/tie_fit.hpp"

#include "scenarios/monitoring/downward_acceleration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace bris {

namespace {

constexpr double wave_numbers = 4;
constexpr double most_left = 0.2;          // three hanging ties left 0.32, single ones at most 0.13
constexpr unsigned gaps = 40, shares = 20; // of the grid
constexpr double as_well = 2; // times what the best fit leaves: most of that is no noise

/// m along the track: how far the rail, and with it a tie that nothing carries, comes down.
std::vector<double> free_deflection(const PassingTrain& passing) {
    constexpr double deep = 1; // m, a gap that no rail closes
    const double ends = passing.rails.reach();
    TrackRail rail = passing.rails.rail(passing.dead_load, deep);
    const std::size_t middle = passing.rails.ties_on_each_side();
    const double at_rest = rail.under({}).at_ties[middle];
    const auto& axles = passing.train.axles;
    const auto points =
        static_cast<std::size_t>((passing.train.length() + 2 * ends) / pattern_spacing) + 1;
    std::vector<RailLoad> loads(axles.size());
    std::vector<double> deflection;
    for (std::size_t k = 0; k < points; ++k) {
        const double first = static_cast<double>(k) * pattern_spacing - ends;
        for (std::size_t i = 0; i < axles.size(); ++i)
            loads[i] = {first - axles[i].behind, axles[i].load};
        deflection.push_back(rail.under(loads).at_ties[middle] - at_rest);
    }
    return deflection;
}

/// A tie with this gap (m) and share of what the rail would come down further without its bed.
struct Support {
    double gap, share;
    double deflection(double of_rail) const {
        return of_rail < gap ? of_rail : gap + share * (of_rail - gap);
    }
};

struct Trial {
    Support support;
    double left; ///< share of the power
};

/// All supports of the grid: the last one is that of a tie which its bed never carries.
std::vector<Trial> trials(const PatternMatching& matching, const std::vector<double>& free,
                          double deepest, double speed) {
    std::vector<Trial> all;
    std::vector<double> pattern(free.size());
    const auto add = [&](const Support& support) {
        std::ranges::transform(free, pattern.begin(),
                               [&](double w) { return support.deflection(w); });
        all.push_back({support, matching.left_by(pattern, speed)});
    };
    for (unsigned g = 0; g < gaps; ++g)
        for (unsigned s = 1; s < shares; ++s)
            add({deepest * g / gaps, static_cast<double>(s) / shares});
    add({deepest, 1});
    return all;
}

/// `value` of the best trial, and its range among those that leave at most `most`.
template <class Value>
Estimate estimate(const std::vector<Trial>& all, const Trial& best, double most, Value&& value) {
    Estimate found{value(best.support), value(best.support), value(best.support)};
    for (const Trial& trial : all)
        if (trial.left <= most) {
            found.low = std::min(found.low, value(trial.support));
            found.high = std::max(found.high, value(trial.support));
        }
    return found;
}

std::string reason_against(const PatternMatching& matching, double lowest) {
    if (matching.band() < 2 * lowest)
        return fmt::format("a train so slow has its load below {:.2g} Hz, expected {:g} or more",
                           matching.band(), 2 * lowest);
    if (!(matching.power() > 0))
        return fmt::format("nothing between {:g} and {:.2g} Hz", lowest, matching.band());
    return {};
}

} // namespace

TieFit fit_tie(const Recording& recording, const PassingTrain& passing, double lowest) {
    TieFit fit;
    const double lasts = passing_time(passing.train, passing.speed, passing.rails);
    const DownwardAcceleration down = downward_acceleration(recording, lasts, lowest);
    fit.impossible_because = down.impossible_because;
    if (!fit.impossible_because.empty()) return fit;
    const PatternMatching matching(down.series, down.rate, passing, lowest, wave_numbers);
    fit.impossible_because = reason_against(matching, lowest);
    if (!fit.impossible_because.empty()) return fit;
    const std::vector<double> free = free_deflection(passing);
    const double deepest = std::ranges::max(free);
    fit.speed = matching.best(free).speed;
    fit.band = matching.band();
    const std::vector<Trial> all = trials(matching, free, deepest, fit.speed);
    const Trial best = *std::ranges::min_element(all, {}, &Trial::left);
    fit.left = best.left;
    if (!(fit.left <= most_left)) {
        fit.impossible_because = fmt::format(
            "a tie under this train, beside ties that are carried, leaves {:.2g} of the power "
            "between {:g} and {:.2g} Hz, expected at most {:g}",
            fit.left, lowest, fit.band, most_left);
        return fit;
    }
    const double most = as_well * best.left;
    fit.is_carried = all.back().left > most;
    fit.gap = estimate(all, best, most, [](const Support& s) { return s.gap; });
    fit.deflection =
        estimate(all, best, most, [&](const Support& s) { return s.deflection(deepest); });
    return fit;
}

} // namespace bris
