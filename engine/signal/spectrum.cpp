#include "engine/signal/spectrum.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/chi_squared.hpp"
#include "engine/math.hpp"
#include "engine/signal/fft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bris {

namespace {

double real(std::size_t n) { return static_cast<double>(n); }

double sum_of_squares(std::span<const double> values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// Calls visit(bin) for the bins from `low` to `high` (Hz).
template <class Visit>
void for_bins_within(const Spectrum& spectrum, double low, double high, Visit&& visit) {
    const double tolerance = 1e-9 * spectrum.spacing; // a limit may be the frequency of a bin
    for (std::size_t k = 0; k < spectrum.density.size(); ++k)
        if (spectrum.frequency(k) >= low - tolerance && spectrum.frequency(k) <= high + tolerance)
            visit(k);
}

/// Sum over all m of the squared correlation between segments m steps apart, per segment of a run
/// of `segments`: the variance of their mean over that of one, times `segments`.
double variance_of_sum(std::size_t segments, std::span<const double> window, std::size_t step) {
    const double squares = sum_of_squares(window);
    double sum = real(segments);
    for (std::size_t m = 1; m < segments && m * step < window.size(); ++m) {
        double product = 0;
        for (std::size_t k = 0; k + m * step < window.size(); ++k)
            product += window[k] * window[k + m * step];
        sum += 2 * real(segments - m) * (product / squares) * (product / squares);
    }
    return sum;
}

} // namespace

std::vector<double> window_of(Window window, std::size_t n) {
    std::vector<double> values(n, 1.0);
    if (window == Window::hann)
        for (std::size_t k = 0; k < n; ++k)
            values[k] = 0.5 - 0.5 * std::cos(2 * pi * real(k) / real(n));
    return values;
}

double equivalent_noise_bandwidth(std::span<const double> window) {
    const double sum = std::accumulate(window.begin(), window.end(), 0.0);
    return real(window.size()) * sum_of_squares(window) / (sum * sum);
}

void detrend(std::span<double> series, Detrend what) {
    if (what == Detrend::nothing || series.empty()) return;
    const double n = real(series.size()),
                 mean = std::accumulate(series.begin(), series.end(), 0.0) / n;
    double slope = 0;
    const double middle = (n - 1) / 2;
    if (what == Detrend::line && series.size() > 1) {
        for (std::size_t k = 0; k < series.size(); ++k)
            slope += (real(k) - middle) * (series[k] - mean);
        slope /= n * (n * n - 1) / 12;
    }
    for (std::size_t k = 0; k < series.size(); ++k) series[k] -= mean + slope * (real(k) - middle);
}

std::vector<double> periodogram(std::span<const double> series) {
    Fft fft(series.size());
    std::vector<double> power;
    for (const auto& x : fft.transform(series)) power.push_back(std::norm(x) / real(series.size()));
    return power;
}

std::vector<double> smoothed_by_daniell(const std::vector<double>& power, std::size_t length,
                                        std::size_t half_width) {
    const auto n = static_cast<std::ptrdiff_t>(length), m = static_cast<std::ptrdiff_t>(half_width);
    require(2 * half_width < length,
            fmt::format("window of Daniell: expected fewer than {} bins, found {}", length,
                        2 * half_width + 1));
    std::vector<double> smooth;
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(power.size()); ++k) {
        double sum = 0;
        for (std::ptrdiff_t j = k - m; j <= k + m; ++j) {
            const std::ptrdiff_t around = ((j % n) + n) % n;
            sum += power[static_cast<std::size_t>(std::min(around, n - around))];
        }
        smooth.push_back(sum / real(2 * half_width + 1));
    }
    return smooth;
}

Spectrum smoothed_periodogram(std::span<const double> series, double rate,
                              const SmoothingSettings& settings) {
    require(rate > 0, "spectrum: expected a sampling rate above 0");
    std::vector<double> values(series.begin(), series.end());
    detrend(values, settings.detrend);
    const std::size_t n = values.size(), bins = 2 * settings.half_width + 1;
    Spectrum s{.length = n,
               .spacing = rate / real(n),
               .bandwidth = rate / real(n) * real(bins),
               .segments = 1,
               .degrees_of_freedom = 2 * real(bins),
               .density = smoothed_by_daniell(periodogram(values), n, settings.half_width)};
    for (std::size_t k = 0; k < s.density.size(); ++k)
        s.density[k] *= (s.is_doubled(k) ? 2 : 1) / rate;
    return s;
}

Spectrum welch(Runs runs, double rate, const WelchSettings& settings) {
    require(rate > 0 && settings.overlap >= 0 && settings.overlap < 1,
            "spectrum: expected a sampling rate above 0 and an overlap from 0 to below 1");
    const std::size_t n = settings.segment;
    const std::size_t step =
        std::max<std::size_t>(1, n - static_cast<std::size_t>(settings.overlap * real(n)));
    Fft fft(n);
    const std::vector<double> window = window_of(settings.window, n);
    Spectrum s{.length = n,
               .spacing = rate / real(n),
               .bandwidth = rate / real(n) * equivalent_noise_bandwidth(window),
               .density = std::vector<double>(n / 2 + 1, 0.0)};
    double variance = 0;
    std::vector<double> values(n);
    for (const std::vector<double>& run : runs) {
        std::size_t of_run = 0;
        for (std::size_t begin = 0; begin + n <= run.size(); begin += step, ++of_run) {
            std::copy_n(run.begin() + static_cast<std::ptrdiff_t>(begin), n, values.begin());
            detrend(values, settings.detrend);
            for (std::size_t k = 0; k < n; ++k) values[k] *= window[k];
            const auto x = fft.transform(values);
            for (std::size_t k = 0; k < x.size(); ++k) s.density[k] += std::norm(x[k]);
        }
        s.segments += of_run;
        if (of_run > 0) variance += variance_of_sum(of_run, window, step);
    }
    require(s.segments > 0,
            fmt::format("spectrum: expected a series of at least {} samples, found none", n));
    const double scale = 1 / (rate * sum_of_squares(window) * real(s.segments));
    for (std::size_t k = 0; k < s.density.size(); ++k)
        s.density[k] *= (s.is_doubled(k) ? 2 : 1) * scale;
    s.degrees_of_freedom = 2 * real(s.segments) * real(s.segments) / variance;
    return s;
}

Spectrum welch(const std::vector<double>& series, double rate, const WelchSettings& settings) {
    return welch(Runs(&series, 1), rate, settings);
}

ConfidenceFactors confidence_factors(double degrees_of_freedom, double probability) {
    const double nu = degrees_of_freedom;
    return {nu / chi_squared_quantile((1 + probability) / 2, nu),
            nu / chi_squared_quantile((1 - probability) / 2, nu)};
}

double band_power(const Spectrum& spectrum, double low, double high) {
    double sum = 0;
    for_bins_within(spectrum, low, high, [&](std::size_t k) { sum += spectrum.density[k]; });
    return sum * spectrum.spacing;
}

double spectral_entropy(const Spectrum& spectrum, double low, double high) {
    double sum = 0, bins = 0, entropy = 0;
    for_bins_within(spectrum, low, high, [&](std::size_t k) {
        sum += spectrum.density[k];
        ++bins;
    });
    if (!(sum > 0) || bins < 2) return std::numeric_limits<double>::quiet_NaN();
    for_bins_within(spectrum, low, high, [&](std::size_t k) {
        const double p = spectrum.density[k] / sum;
        if (p > 0) entropy -= p * std::log(p);
    });
    return entropy / std::log(bins);
}

} // namespace bris
