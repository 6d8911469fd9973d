#include "engine/signal/displacement.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/signal/fft.hpp"
#include "engine/signal/spectrum.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Part of a frequency that is kept.
double kept(double frequency, double lowest) {
    const double x = std::clamp(2 * frequency / lowest - 1, 0.0, 1.0);
    return 0.5 * (1 - std::cos(pi * x));
}

/// The series with its spectrum times factor(frequency), between zeros.
template <class Factor>
std::vector<double> filtered(std::vector<double> series, double rate, double lowest,
                             Factor&& factor) {
    require(lowest > 0 && rate > 2 * lowest && series.size() >= 3,
            "displacement: expected at least 3 samples, and a rate above twice the lowest "
            "frequency, which is above 0");
    const std::size_t samples = series.size();
    const auto margin = static_cast<std::size_t>(std::ceil(2 * rate / lowest));
    Fft fft(fast_length_for(samples + 2 * margin));
    series.insert(series.begin(), margin, 0.0);
    series.resize(fft.length(), 0.0);
    auto spectrum = fft.transform(series);
    spectrum[0] = 0;
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        spectrum[k] *= factor(rate * static_cast<double>(k) / static_cast<double>(fft.length()));
    const auto whole = fft.series_of(spectrum);
    const auto first = whole.begin() + static_cast<std::ptrdiff_t>(margin);
    return {first, first + static_cast<std::ptrdiff_t>(samples)};
}

} // namespace

std::vector<double> displacement_of(std::span<const double> acceleration, double rate,
                                    double lowest) {
    std::vector<double> series(acceleration.begin(), acceleration.end());
    if (series.size() >= 3) detrend(series, Detrend::line);
    return filtered(std::move(series), rate, lowest,
                    [&](double f) { return -kept(f, lowest) / std::pow(2 * pi * f, 2); });
}

std::vector<double> without_slow_motion(std::span<const double> displacement, double rate,
                                        double lowest) {
    return filtered({displacement.begin(), displacement.end()}, rate, lowest,
                    [&](double f) { return kept(f, lowest); });
}

double displacement_noise(double noise, double lowest) {
    // integral of 2 noise^2 kept^2 / (2 pi f)^4 over f: midpoints up to `lowest`, exact beyond
    constexpr int parts = 1000;
    double sum = 1 / (3 * std::pow(lowest, 3));
    for (int k = 0; k < parts; ++k) {
        const double f = lowest * (0.5 + 0.5 * (k + 0.5) / parts);
        sum += 0.5 * lowest / parts * std::pow(kept(f, lowest) / (f * f), 2);
    }
    return noise * std::sqrt(2 * sum) / std::pow(2 * pi, 2);
}

double largest_fall(std::span<const double> series, double least) {
    double fall = 0, high = series.empty() ? 0 : series.front(), low = high;
    for (const double x : series) {
        if (x > low + least) { // a rise that ends the fall
            high = low = x;
        } else if (x > high) {
            high = low = x;
        } else {
            low = std::min(low, x);
            fall = std::max(fall, high - low);
        }
    }
    return fall;
}

} // namespace bris
