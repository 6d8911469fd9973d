#include "scenarios/monitoring/passing_pattern.hpp"

#include "engine/math.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace bris {

namespace {

constexpr double speed_range = 0.05; // on either side of the stated speed
constexpr double misplaced = 0.5;    // m, of the last axle between two speeds that are tried
constexpr double reach = 0.5;        // s, of the beginning of the load before the series

double power_of(const std::vector<std::complex<double>>& spectrum) {
    double sum = 0;
    for (const auto& x : spectrum) sum += std::norm(x);
    return sum;
}

} // namespace

PatternMatching::PatternMatching(std::span<const double> acceleration, double rate,
                                 const PassingTrain& passing, double lowest, double wave_numbers)
    : duration_(static_cast<double>(acceleration.size()) / rate), lowest_(lowest) {
    const auto margin = static_cast<std::size_t>(std::ceil(2 * rate / lowest));
    length_ = fast_length_for(acceleration.size() + 2 * margin);
    period_ = static_cast<double>(length_) / rate;
    std::vector<double> whole(acceleration.begin(), acceleration.end());
    whole.resize(length_, 0.0);
    series_ = Fft(length_).transform(whole);
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

PatternMatching::Match PatternMatching::best(const std::vector<double>& pattern) const {
    Match best;
    for (const double speed : speeds_) {
        const Spectrum spectrum = spectrum_of(pattern, speed);
        const Lagged at = best_lag(spectrum, duration_of(pattern, speed));
        const double norm = power_ * power_of(spectrum),
                     goodness = norm > 0 ? std::pow(at.product, 2) / norm : 0;
        if (goodness > best.goodness) best = {goodness, speed, at.lag};
    }
    return best;
}

double PatternMatching::left_by(const std::vector<double>& pattern, double speed) const {
    const Spectrum spectrum = spectrum_of(pattern, speed);
    // spectra are sums over different numbers of samples
    const double factor = static_cast<double>(length_) / static_cast<double>(short_),
                 product = factor * best_lag(spectrum, duration_of(pattern, speed)).product;
    return (power_ - 2 * product + factor * factor * power_of(spectrum)) / power_;
}

/// Part of a frequency that is kept, as by without_slow_part.
double PatternMatching::kept(std::size_t k) const {
    const double x = std::clamp(2 * static_cast<double>(k) / period_ / lowest_ - 1, 0.0, 1.0);
    return 0.5 * (1 - std::cos(pi * x));
}

PatternMatching::Spectrum PatternMatching::spectrum_of(const std::vector<double>& pattern,
                                                       double speed) const {
    std::vector<double> samples(short_, 0.0);
    const double step = period_ / static_cast<double>(short_) * speed / pattern_spacing;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double place = static_cast<double>(k) * step;
        const auto n = static_cast<std::size_t>(place);
        if (n + 1 >= pattern.size()) break;
        samples[k] = pattern[n] + (place - static_cast<double>(n)) * (pattern[n + 1] - pattern[n]);
    }
    Spectrum spectrum = fft_->transform(samples);
    spectrum.resize(series_.size());
    for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= weights_[k];
    return spectrum;
}

std::vector<double> PatternMatching::in_time(Spectrum spectrum) const {
    spectrum.resize(short_ / 2 + 1);
    return fft_->series_of(spectrum);
}

double PatternMatching::time_of(std::size_t sample) const {
    const double t = static_cast<double>(sample) * period_ / static_cast<double>(short_);
    return t > 0.5 * (period_ + duration_) ? t - period_ : t;
}

PatternMatching::Lagged PatternMatching::best_lag(const Spectrum& pattern, double lasts) const {
    Spectrum products(series_.size());
    for (std::size_t k = 0; k < series_.size(); ++k)
        products[k] = series_[k] * std::conj(pattern[k]);
    const auto correlation = in_time(std::move(products));
    const double latest = std::max(0.0, duration_ - lasts) + reach;
    double most = 0, at = 0;
    for (std::size_t k = 0; k < short_; ++k) {
        const double lag = time_of(k);
        if (lag < -reach || lag > latest || correlation[k] <= most) continue;
        most = correlation[k];
        at = lag;
    }
    const double half = 0.5 * static_cast<double>(short_); // of the sum over both signs
    return {half * most, at};
}

std::string PatternMatching::contradiction(const std::vector<double>& pattern,
                                           const Match& match) const {
    constexpr std::size_t parts = 3;
    constexpr double seen = 3;           // standard deviations
    constexpr double most_beyond = 4;    // power of the rest beyond the train over that within it
    constexpr double least_beyond = 0.1; // energy of the rest beyond the train over the explained
    Spectrum moved = spectrum_of(pattern, match.speed);
    for (std::size_t k = 0; k < moved.size(); ++k)
        moved[k] *= std::polar(1.0, -2 * pi * static_cast<double>(k) * match.lag / period_);
    const auto shape = in_time(std::move(moved));
    auto rest = in_time(series_);
    const double lasts = duration_of(pattern, match.speed);
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

} // namespace bris
