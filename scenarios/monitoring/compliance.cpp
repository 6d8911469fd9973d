#include "scenarios/monitoring/compliance.hpp"

#include "engine/signal/matched_shape.hpp"
#include "scenarios/monitoring/downward_acceleration.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// The load at the samples, less its value at rest; the rails do not lift the tie.
std::vector<double> load_at_samples(const LoadHistory& load, double rate) {
    std::vector<double> series;
    const auto samples = static_cast<std::size_t>(std::ceil(load.times.back() * rate));
    for (std::size_t k = 0; k <= samples; ++k)
        series.push_back(std::max(0.0, load.at(static_cast<double>(k) / rate)) -
                         load.values.front());
    return series;
}

} // namespace

RecordedCompliance compliance_of(const Recording& recording, const PassingTrain& passing,
                                 double lowest) {
    constexpr double reach = 0.5;     // s, of the beginning of the load
    constexpr double seen = 3;        // standard deviations
    constexpr double nonlinear = 0.1; // of the compliance, standard deviation
    RecordedCompliance found;
    const auto load_at = [&](double speed) {
        return passing_load(passing.train, speed, passing.rails, passing.dead_load);
    };
    const DownwardAcceleration down =
        downward_acceleration(recording, load_at(passing.speed).times.back(), lowest);
    found.impossible_because = down.impossible_because;
    if (!found.impossible_because.empty()) return found;
    found.fit = fit_train(down.series, down.rate, passing, lowest);
    found.impossible_because = found.fit.refused_because;
    if (!found.impossible_because.empty()) return found;
    const LoadHistory load = load_at(found.fit.speed);
    const auto shape = without_slow_part(load_at_samples(load, down.rate), down.rate, lowest, 2);
    // a recording may begin long before the train comes
    const double spare = down.duration - load.times.back();
    const auto most = static_cast<long>((reach + std::max(0.0, spare)) * down.rate);
    const MatchedShape match =
        match_shape(without_slow_part(down.series, down.rate, lowest), shape, most);
    found.value = match.factor;
    found.deviation = std::hypot(match.deviation, nonlinear * match.factor);
    if (!(match.factor > seen * match.deviation))
        found.impossible_because = "the load of the train is not seen in it";
    return found;
}

} // namespace bris
