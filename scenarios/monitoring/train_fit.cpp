#include "scenarios/monitoring/train_fit.hpp"

#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/fft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

namespace bris {

namespace {

constexpr double level = 0.01;        // of the test
constexpr unsigned shuffles = 199;    // of each kind
constexpr unsigned enough = 10;       // that fit as well: more would not change the verdict
constexpr double largest_stretch = 2; // of a distance between axles
constexpr double wave_numbers = 5; // of the rails, beyond which an axle's load has 1 % of its power
constexpr double least_goodness = 0.25;
constexpr std::uint64_t seed = 1, stream = 884;

/// The load (N) of a train on a tie along the track, less that at rest, in steps of
/// `pattern_spacing`; the rails do not lift the tie.
std::vector<double> load_along(const Train& train, const PassingTrain& passing) {
    const double ends = passing.rails.reach();
    const InfluenceLine share = passing.rails.influence();
    const auto points = static_cast<std::size_t>((train.length() + 2 * ends) / pattern_spacing) + 1;
    std::vector<double> load(fast_length_for(points), passing.dead_load);
    for (const Axle& axle : train.axles) {
        const double middle = ends + axle.behind;
        const auto first = static_cast<std::size_t>((middle - ends) / pattern_spacing),
                   last = std::min(load.size(),
                                   static_cast<std::size_t>((middle + ends) / pattern_spacing) + 1);
        for (std::size_t k = first; k < last; ++k)
            load[k] += axle.load * share(static_cast<double>(k) * pattern_spacing - middle);
    }
    for (double& force : load) force = std::max(0.0, force) - passing.dead_load;
    return load;
}

Train with_shuffled_axles(const Train& train, Random& random) {
    std::vector<double> distances, loads{train.axles.front().load};
    for (std::size_t k = 1; k < train.axles.size(); ++k) {
        distances.push_back(train.axles[k].behind - train.axles[k - 1].behind);
        loads.push_back(train.axles[k].load);
    }
    const auto shuffle = [&](std::vector<double>& values) {
        for (std::size_t k = values.size(); k > 1; --k)
            std::swap(values[k - 1],
                      values[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
    };
    shuffle(distances);
    shuffle(loads);
    for (double& d : distances) d *= std::pow(largest_stretch, random.uniform(-1, 1));
    const double sum = std::accumulate(distances.begin(), distances.end(), 0.0);
    Train shuffled{.name = train.name, .axles = {{0, loads.front()}}};
    for (std::size_t k = 0; k < distances.size(); ++k)
        shuffled.axles.push_back(
            {shuffled.axles.back().behind + distances[k] * train.length() / sum, loads[k + 1]});
    return shuffled;
}

std::vector<double> with_shuffled_phases(const std::vector<double>& load, Random& random) {
    Fft fft(load.size());
    auto spectrum = fft.transform(load);
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        spectrum[k] *= std::polar(1.0, 2 * pi * random.uniform());
    return fft.series_of(spectrum);
}

/// Share of shuffled patterns that fit as well (Besag and Clifford 1991, Biometrika 78:301).
template <class Shuffled>
double p_value(const PatternMatching& matching, double goodness, Shuffled&& shuffled) {
    unsigned as_well = 0;
    for (unsigned k = 1; k <= shuffles; ++k) {
        if (matching.best(shuffled()).goodness >= goodness) ++as_well;
        if (as_well == enough) return static_cast<double>(enough) / k;
    }
    return static_cast<double>(as_well + 1) / (shuffles + 1);
}

} // namespace

TrainFit fit_train(std::span<const double> acceleration, double rate, const PassingTrain& passing,
                   double lowest) {
    const PatternMatching matching(acceleration, rate, passing, lowest, wave_numbers);
    const auto load = load_along(passing.train, passing);
    const PatternMatching::Match match = matching.best(load);
    TrainFit fit{.speed = match.speed, .goodness = match.goodness, .band = matching.band()};
    Random random(seed, stream);
    const double phases = p_value(matching, match.goodness,
                                  [&] { return with_shuffled_phases(load, random); }),
                 axles = p_value(matching, match.goodness, [&] {
                     return load_along(with_shuffled_axles(passing.train, random), passing);
                 });
    fit.p_value = std::max(phases, axles);
    if (fit.p_value > level)
        fit.refused_because = fmt::format(
            "it fits the train no better than {} do (p = {:.2g}, expected at most {:g})",
            phases > axles ? "its shuffled phases" : "trains of shuffled axles", fit.p_value,
            level);
    else if (fit.goodness < least_goodness)
        fit.refused_because = fmt::format(
            "the train explains {:.2g} of the power between {:g} and {:.2g} Hz, expected at least "
            "{:g}: mostly noise, or a longer train",
            fit.goodness, lowest, fit.band, least_goodness);
    else
        fit.refused_because = matching.contradiction(load, match);
    return fit;
}

} // namespace bris
