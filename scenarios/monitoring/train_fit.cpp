#include "scenarios/monitoring/train_fit.hpp"

#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/fft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <numeric>
#include <vector>

namespace bris {

namespace {

constexpr double level = 0.01;        // of the test
constexpr unsigned shuffles = 199;    // of each kind
constexpr unsigned enough = 10;       // that fit as well: more would not change the verdict
constexpr double speed_range = 0.05;  // on either side of the stated speed
constexpr double misplaced = 0.5;     // m, of the last axle between two speeds that are tried
constexpr double reach = 0.5;         // s, of the beginning of the load before the series
constexpr double spacing = 0.05;      // m, of a load along the track
constexpr double largest_stretch = 2; // of a distance between axles
constexpr double wave_numbers = 5; // of the rails, beyond which an axle's load has 1 % of its power
constexpr double least_goodness = 0.25;
constexpr std::uint64_t seed = 1, stream = 884;

using Spectrum = std::vector<std::complex<double>>;

/// The load (N) of a train on a tie along the track, less that at rest, in steps of `spacing`; the
/// rails do not lift the tie.
std::vector<double> load_along(const Train& train, const PassingTrain& passing) {
    const double ends = passing.rails.reach();
    const InfluenceLine share = passing.rails.influence();
    const auto points = static_cast<std::size_t>((train.length() + 2 * ends) / spacing) + 1;
    std::vector<double> load(fast_length_for(points), passing.dead_load);
    for (const Axle& axle : train.axles) {
        const double middle = ends + axle.behind;
        const auto first = static_cast<std::size_t>((middle - ends) / spacing),
                   last = std::min(load.size(),
                                   static_cast<std::size_t>((middle + ends) / spacing) + 1);
        for (std::size_t k = first; k < last; ++k)
            load[k] += axle.load * share(static_cast<double>(k) * spacing - middle);
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
    Spectrum spectrum = fft.transform(load);
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        spectrum[k] *= std::polar(1.0, 2 * pi * random.uniform());
    return fft.series_of(spectrum);
}

double power_of(const Spectrum& spectrum) {
    double sum = 0;
    for (const auto& x : spectrum) sum += std::norm(x);
    return sum;
}

/// A pattern at the lag and speed at which it fits best.
struct Match {
    double goodness = 0, speed = 0, lag = 0; // 1, m/s, s
};

/// The series without what lies below and above the band of the train, as a spectrum, to which
/// patterns are matched.
class Matching {
public:
    Matching(std::span<const double> acceleration, double rate, const PassingTrain& passing,
             double lowest)
        : duration_(static_cast<double>(acceleration.size()) / rate), lowest_(lowest) {
        const auto margin = static_cast<std::size_t>(std::ceil(2 * rate / lowest));
        const std::size_t length = fast_length_for(acceleration.size() + 2 * margin);
        period_ = static_cast<double>(length) / rate;
        std::vector<double> whole(acceleration.begin(), acceleration.end());
        whole.resize(length, 0.0);
        series_ = Fft(length).transform(whole);
        const double band = wave_numbers * passing.rails.wave_number() * passing.speed / (2 * pi);
        series_.resize(std::min(series_.size(), static_cast<std::size_t>(band * period_) + 1));
        short_ = fast_length_for(4 * series_.size());
        fft_ = std::make_unique<Fft>(short_);
        for (std::size_t k = 0; k < series_.size(); ++k) {
            series_[k] *= kept(k);
            weights_.push_back(-kept(k) * std::pow(2 * pi * static_cast<double>(k) / period_, 2));
        }
        power_ = power_of(series_);
        const auto steps =
            static_cast<int>(std::ceil(speed_range * (passing.train.length() + 1) / misplaced));
        for (int k = -steps; k <= steps; ++k)
            speeds_.push_back(passing.speed * (1 + speed_range * k / steps));
    }

    double band() const { return static_cast<double>(series_.size()) / period_; }

    Match best(const std::vector<double>& load) const {
        Match best;
        for (const double speed : speeds_) {
            const Spectrum pattern = pattern_of(load, speed);
            const Match at = best_lag(pattern, duration_of(load, speed));
            if (at.goodness > best.goodness) best = {at.goodness, speed, at.lag};
        }
        return best;
    }

    /// Why the series is not the train that matches it, from what single parts of it say; empty if
    /// they agree.
    std::string contradiction(const std::vector<double>& load, const Match& match) const;

private:
    /// Part of a frequency that is kept, as by without_slow_part.
    double kept(std::size_t k) const {
        const double x = std::clamp(2 * static_cast<double>(k) / period_ / lowest_ - 1, 0.0, 1.0);
        return 0.5 * (1 - std::cos(pi * x));
    }
    static double duration_of(const std::vector<double>& load, double speed) {
        return static_cast<double>(load.size()) * spacing / speed;
    }
    Spectrum pattern_of(const std::vector<double>& load, double speed) const {
        std::vector<double> samples(short_, 0.0);
        const double step = period_ / static_cast<double>(short_) * speed / spacing;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double place = static_cast<double>(k) * step;
            const auto n = static_cast<std::size_t>(place);
            if (n + 1 >= load.size()) break;
            samples[k] = load[n] + (place - static_cast<double>(n)) * (load[n + 1] - load[n]);
        }
        Spectrum spectrum = fft_->transform(samples);
        spectrum.resize(series_.size());
        for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= weights_[k];
        return spectrum;
    }
    std::vector<double> in_time(Spectrum spectrum) const {
        spectrum.resize(short_ / 2 + 1);
        return fft_->series_of(spectrum);
    }
    double time_of(std::size_t sample) const {
        const double t = static_cast<double>(sample) * period_ / static_cast<double>(short_);
        return t > 0.5 * (period_ + duration_) ? t - period_ : t;
    }
    Match best_lag(const Spectrum& pattern, double lasts) const {
        Spectrum products(series_.size());
        for (std::size_t k = 0; k < series_.size(); ++k)
            products[k] = series_[k] * std::conj(pattern[k]);
        const auto correlation = in_time(std::move(products));
        const double latest = std::max(0.0, duration_ - lasts) + reach;
        double most = 0;
        Match best;
        for (std::size_t k = 0; k < short_; ++k) {
            const double lag = time_of(k);
            if (lag < -reach || lag > latest || correlation[k] <= most) continue;
            most = correlation[k];
            best.lag = lag;
        }
        const double norm = power_ * power_of(pattern);
        const double half = 0.5 * static_cast<double>(short_); // of the sum over both signs
        if (norm > 0) best.goodness = std::pow(half * most, 2) / norm;
        return best;
    }

    double duration_, lowest_, period_ = 0, power_ = 0; // s, Hz, s
    Spectrum series_;
    std::vector<double> weights_; // of frequencies in the second derivative of a pattern
    std::size_t short_ = 0;       // samples of a period that hold the band twice over
    std::unique_ptr<Fft> fft_;
    std::vector<double> speeds_;
};

std::string Matching::contradiction(const std::vector<double>& load, const Match& match) const {
    constexpr std::size_t parts = 3;
    constexpr double seen = 3;           // standard deviations
    constexpr double most_beyond = 4;    // power of the rest beyond the train over that within it
    constexpr double least_beyond = 0.1; // energy of the rest beyond the train over the explained
    Spectrum moved = pattern_of(load, match.speed);
    for (std::size_t k = 0; k < moved.size(); ++k)
        moved[k] *= std::polar(1.0, -2 * pi * static_cast<double>(k) * match.lag / period_);
    const auto shape = in_time(std::move(moved));
    auto rest = in_time(series_);
    const double lasts = duration_of(load, match.speed);
    const double all = std::inner_product(shape.begin(), shape.end(), shape.begin(), 0.0),
                 whole = std::inner_product(shape.begin(), shape.end(), rest.begin(), 0.0) / all;
    // thirds of equal energy, in the order of time
    std::vector<std::size_t> order(short_), part(short_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return time_of(k); });
    std::array<double, parts> products{}, squares{}, factors{};
    double sum = 0;
    for (const std::size_t k : order) {
        part[k] = std::min(parts - 1, static_cast<std::size_t>(parts * sum / all));
        sum += shape[k] * shape[k];
        products[part[k]] += shape[k] * rest[k];
        squares[part[k]] += shape[k] * shape[k];
    }
    for (std::size_t p = 0; p < parts; ++p) factors[p] = products[p] / squares[p];
    double within = 0, beyond = 0, samples_within = 0, samples_beyond = 0;
    for (std::size_t k = 0; k < short_; ++k) {
        rest[k] -= factors[part[k]] * shape[k];
        const double t = time_of(k);
        if (t < 0 || t > duration_) continue;
        const bool passes = t >= match.lag && t <= match.lag + lasts;
        (passes ? within : beyond) += rest[k] * rest[k];
        (passes ? samples_within : samples_beyond) += 1;
    }
    for (std::size_t p = 0; p < parts; ++p) {
        // the band is half of what the samples could hold, so every second one is independent
        const double deviation = std::sqrt(2 * within / samples_within / squares[p]);
        if (factors[p] + seen * deviation < 0.5 * whole ||
            factors[p] - seen * deviation > 2 * whole)
            return fmt::format("part {} of {} of the train is seen with {:.2g} times the movement "
                               "of the whole: another train, or one whose speed changes",
                               p + 1, parts, factors[p] / whole);
    }
    if (beyond > least_beyond * whole * whole * all &&
        beyond * samples_within > most_beyond * within * samples_beyond)
        return "more than this train passes in it";
    return {};
}

/// Share of shuffled patterns that fit as well (Besag and Clifford 1991, Biometrika 78:301).
template <class Shuffled>
double p_value(const Matching& matching, double goodness, Shuffled&& shuffled) {
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
    const Matching matching(acceleration, rate, passing, lowest);
    const auto load = load_along(passing.train, passing);
    const Match match = matching.best(load);
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
