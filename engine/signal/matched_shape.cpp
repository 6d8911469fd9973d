#include "engine/signal/matched_shape.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/signal/fft.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

/// Part of a frequency that is kept.
double kept(double frequency, double lowest) {
    const double x = std::clamp(2 * frequency / lowest - 1, 0.0, 1.0);
    return 0.5 * (1 - std::cos(pi * x));
}

/// The shape moved by a lag, as long as the series.
std::vector<double> moved(std::span<const double> shape, long lag, std::size_t length) {
    std::vector<double> all(length, 0.0);
    for (std::size_t k = 0; k < length; ++k) {
        const long from = static_cast<long>(k) - lag;
        if (from >= 0 && from < static_cast<long>(shape.size()))
            all[k] = shape[static_cast<std::size_t>(from)];
    }
    return all;
}

double product(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
}

/// Sum of the products of the series and the shape moved by a lag.
double correlation_at(std::span<const double> series, std::span<const double> shape, long lag) {
    const auto begin = static_cast<std::size_t>(std::max(0L, lag)),
               skipped = static_cast<std::size_t>(std::max(0L, -lag));
    if (begin >= series.size() || skipped >= shape.size()) return 0;
    const std::size_t both = std::min(series.size() - begin, shape.size() - skipped);
    return product(series.subspan(begin, both), shape.subspan(skipped, both));
}

/// |X_k|^2 / n of a series of n samples, continued by zeros: its variance, if it is white noise.
std::vector<double> power_of(std::vector<double> series) {
    const auto samples = static_cast<double>(series.size());
    Fft fft(fast_length_for(series.size()));
    series.resize(fft.length(), 0.0);
    std::vector<double> power;
    for (const auto& x : fft.transform(series)) power.push_back(std::norm(x) / samples);
    return power;
}

/// Mean of the values from 0.7 to 1.4 times each frequency: where a shape is matched, the rest has
/// lost a part of its own.
std::vector<double> smoothed(const std::vector<double>& power) {
    std::vector<double> sum{0}, mean;
    for (const double p : power) sum.push_back(sum.back() + p);
    for (std::size_t k = 0; k < power.size(); ++k) {
        const auto n = static_cast<double>(k);
        const auto from = static_cast<std::size_t>(0.7 * n),
                   to = std::min(power.size(), static_cast<std::size_t>(1.4 * n) + 2);
        mean.push_back((sum[to] - sum[from]) / static_cast<double>(to - from));
    }
    return mean;
}

} // namespace

std::vector<double> without_slow_part(std::span<const double> series, double rate, double lowest,
                                      int derivatives) {
    require(lowest > 0 && rate > 2 * lowest && series.size() >= 3 &&
                (derivatives == 0 || derivatives == 2),
            "slow part: expected at least 3 samples, a rate above twice the lowest frequency, "
            "which is above 0, and 0 or 2 derivatives");
    const auto margin = static_cast<std::size_t>(std::ceil(2 * rate / lowest));
    Fft fft(fast_length_for(series.size() + 2 * margin));
    std::vector<double> whole(fft.length(), 0.0);
    std::ranges::copy(series, whole.begin() + static_cast<std::ptrdiff_t>(margin));
    auto spectrum = fft.transform(whole);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        const double f = rate * static_cast<double>(k) / static_cast<double>(fft.length());
        spectrum[k] *= kept(f, lowest) * (derivatives == 2 ? -std::pow(2 * pi * f, 2) : 1);
    }
    whole = fft.series_of(spectrum);
    const auto first = whole.begin() + static_cast<std::ptrdiff_t>(margin);
    return {first, first + static_cast<std::ptrdiff_t>(series.size())};
}

MatchedShape match_shape(std::span<const double> series, std::span<const double> shape,
                         long reach) {
    require(series.size() >= 3 && product(shape, shape) > 0,
            "shape: expected a series of at least 3 samples and a shape other than zero");
    MatchedShape best;
    double most = -std::numeric_limits<double>::infinity();
    for (long lag = -reach; lag <= reach; ++lag) {
        const double correlation = correlation_at(series, shape, lag);
        if (correlation > most) {
            most = correlation;
            best.lag = lag;
        }
    }
    const auto placed = moved(shape, best.lag, series.size());
    const double squares = product(placed, placed);
    if (!(squares > 0)) return best;
    best.factor = product(series, placed) / squares;
    std::vector<double> rest(series.begin(), series.end());
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= best.factor * placed[k];
    const auto of_shape = power_of(placed), of_rest = smoothed(power_of(rest));
    double weighted = 0, sum = 0; // mean variance of the rest, weighted by the shape
    for (std::size_t k = 0; k < of_shape.size(); ++k) {
        weighted += of_shape[k] * of_rest[k];
        sum += of_shape[k];
    }
    best.deviation = std::sqrt(weighted / sum / squares);
    return best;
}

} // namespace bris
