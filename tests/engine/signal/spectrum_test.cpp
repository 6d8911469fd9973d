#include "engine/errors.hpp"
#include "engine/estimation/chi_squared.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/fft.hpp"
#include "engine/signal/spectrum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

using namespace bris;

namespace {

constexpr double rate = 1000; // Hz

/// Two lines, uniform noise with standard deviation 0.2 from Knuth's congruential generator MMIX
/// (seed 42), and a mean of 0.4. Reference values of this signal are from scipy.signal 1.10.
const std::vector<double>& reference_signal() {
    static const std::vector<double> signal = [] {
        std::vector<double> x;
        std::uint64_t state = 42;
        for (int n = 0; n < 8192; ++n) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            const double u = static_cast<double>(state) / 0x1p64;
            x.push_back(1.5 * std::sin(2 * pi * 62.5 * n / rate) +
                        0.3 * std::cos(2 * pi * 140.3 * n / rate + 0.7) +
                        0.2 * std::sqrt(12.0) * (u - 0.5) + 0.4);
        }
        return x;
    }();
    return signal;
}

std::vector<double> white_noise(std::size_t n, std::uint64_t seed) {
    Random random(seed, 0);
    std::vector<double> x(n);
    for (double& value : x) value = random.normal();
    return x;
}

double sum_of_squares(const std::vector<double>& x) {
    return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
}

} // namespace

TEST_SUITE("engine/signal/spectrum") {
    TEST_CASE("the sum of the report's periodogram is the sum of squares (Parseval)") {
        const auto& x = reference_signal();
        CHECK(x[4] == doctest::Approx(1.8846118296478855).epsilon(1e-13));
        CHECK(sum_of_squares(x) == doctest::Approx(11274.735967756551).epsilon(1e-12));
        const auto power = periodogram(x);
        double sum = power.front() + power.back();
        for (std::size_t k = 1; k + 1 < power.size(); ++k) sum += 2 * power[k];
        CHECK(sum == doctest::Approx(11274.735967756551).epsilon(1e-12));
        const Spectrum density =
            smoothed_periodogram(x, rate, {.half_width = 7, .detrend = Detrend::nothing});
        CHECK(band_power(density, 0, rate / 2) ==
              doctest::Approx(1.376310542939032).epsilon(1e-12));
    }

    TEST_CASE("Welch's method gives the values of scipy.signal.welch") {
        const Spectrum s = welch(reference_signal(), rate, {.segment = 1024});
        CHECK(s.segments == 15);
        CHECK(s.spacing == 0.9765625);
        CHECK(s.bandwidth == doctest::Approx(1.5 * s.spacing).epsilon(1e-13));
        constexpr std::array<std::pair<std::size_t, double>, 10> expected{
            {{0, 5.799367630872229e-06},
             {1, 6.403803373300653e-05},
             {63, 0.19360524269305496},
             {64, 0.7752960307434263},
             {65, 0.19407226002525488},
             {100, 7.101799786260781e-05},
             {143, 0.016871284086921713},
             {144, 0.02642277177864896},
             {300, 4.4979789036161824e-05},
             {512, 3.8487971140803034e-05}}}; // no doubling at the first and the last
        for (const auto& [bin, density] : expected)
            CHECK(s.density[bin] == doctest::Approx(density).epsilon(1e-11));
        CHECK(band_power(s, 0, 500) == doctest::Approx(1.2195019847000106).epsilon(1e-12));
        CHECK(band_power(s, 62 * s.spacing, 66 * s.spacing) ==
              doctest::Approx(1.13583627769409).epsilon(1e-12)); // A^2 / 2 = 1.125
        std::vector<double> floor(s.density.begin() + 200, s.density.begin() + 500);
        std::ranges::sort(floor);
        CHECK(0.5 * (floor[149] + floor[150]) ==
              doctest::Approx(7.708106341427167e-05).epsilon(1e-12));
    }

    TEST_CASE("a sine of amplitude A has the power A^2 / 2, and white noise its level") {
        std::vector<double> sine;
        for (int n = 0; n < 40960; ++n) sine.push_back(3 * std::sin(2 * pi * 33.3 * n / rate));
        CHECK(band_power(welch(sine, rate), 25, 42) == doctest::Approx(4.5).epsilon(0.01));
        const auto noise = white_noise(1 << 20, 3);
        const Spectrum s = welch(noise, rate);
        double level = 0; // 2 sigma^2 / rate; 2047 segments x 400 bins: error of the mean 0.15 %
        for (std::size_t k = 50; k < 450; ++k) level += s.density[k] / 400;
        CHECK(level == doctest::Approx(2 / rate).epsilon(0.006));
        CHECK(spectral_entropy(s, 10, 490) > 0.999);
        CHECK(spectral_entropy(welch(sine, rate), 10, 490) < 0.4);
    }

    TEST_CASE("the report's definition times 2 / rate is Welch's density of one plain segment") {
        std::vector<double> x(reference_signal().begin(), reference_signal().begin() + 6000);
        const Spectrum by_report = smoothed_periodogram(x, rate, {}),
                       by_welch = welch(
                           x, rate, {.segment = 6000, .overlap = 0, .window = Window::rectangular});
        std::vector<double> centred = x;
        detrend(centred, Detrend::mean);
        const auto s_n = periodogram(centred);
        for (std::size_t k = 0; k < s_n.size(); ++k) {
            const double factor = (by_report.is_doubled(k) ? 2 : 1) / rate;
            CHECK(std::abs(by_welch.density[k] - factor * s_n[k]) <=
                  1e-10 * by_welch.density[k] + 1e-28); // nothing is left at 0 Hz
            CHECK(std::abs(by_report.density[k] - by_welch.density[k]) <=
                  1e-10 * by_welch.density[k] + 1e-28);
        }
        // and smoothed over frequency, both by the same window
        const Spectrum smooth = smoothed_periodogram(x, rate, {.half_width = 9});
        double mean = 0;
        for (std::size_t k = 391; k <= 409; ++k) mean += by_welch.density[k] / 19;
        CHECK(smooth.density[400] == doctest::Approx(mean).epsilon(1e-10));
    }

    TEST_CASE(
        "smoothing by Daniell's window multiplies the circular autocovariance by its kernel") {
        // theorem of Wiener and Khinchin: an independent sum over lags
        constexpr std::size_t n = 60, m = 4;
        const auto x = white_noise(n, 8);
        const auto smooth = smoothed_by_daniell(periodogram(x), n, m);
        for (std::size_t k = 0; k < smooth.size(); ++k) {
            double sum = 0;
            for (std::size_t lag = 0; lag < n; ++lag) {
                double covariance = 0;
                for (std::size_t t = 0; t < n; ++t) covariance += x[t] * x[(t + lag) % n];
                const double half = pi * static_cast<double>(lag) / n,
                             kernel = lag == 0 ? 1
                                               : std::sin((2 * m + 1) * half) /
                                                     ((2 * m + 1) * std::sin(half));
                sum += covariance / n * kernel * std::cos(2 * half * static_cast<double>(k));
            }
            CHECK(smooth[k] == doctest::Approx(sum).epsilon(1e-11));
        }
    }

    TEST_CASE("degrees of freedom are those of the scatter of the densities of white noise") {
        // mean^2 / variance of a scaled chi-squared is nu / 2; bins at the same frequency of 2000
        // independent series: the estimate scatters by sqrt(2 / (8 x 2000)) and somewhat more
        constexpr int series = 2000;
        const auto freedom = [&](auto&& estimate, double& stated) {
            std::vector<double> sum(8), squares(8);
            for (int k = 0; k < series; ++k) {
                const Spectrum s = estimate(white_noise(1024, 100 + static_cast<unsigned>(k)));
                stated = s.degrees_of_freedom;
                for (std::size_t b = 0; b < 8; ++b) {
                    const double d = s.density[(b + 1) * s.density.size() / 10];
                    sum[b] += d / series;
                    squares[b] += d * d / series;
                }
            }
            double variance = 0, mean = 0;
            for (std::size_t b = 0; b < 8; ++b) {
                variance += (squares[b] - sum[b] * sum[b]) / 8;
                mean += sum[b] / 8;
            }
            return 2 * mean * mean / variance;
        };
        double stated = 0;
        double found = freedom(
            [](const auto& x) {
                return welch(x, 1, {.segment = 128, .detrend = Detrend::nothing});
            },
            stated);
        CHECK(stated == doctest::Approx(28.4).epsilon(0.01)); // 15 segments of Hann, half overlap
        CHECK(found == doctest::Approx(stated).epsilon(0.06));
        found = freedom([](const auto& x) { return smoothed_periodogram(x, 1, {.half_width = 5}); },
                        stated);
        CHECK(stated == 22);
        CHECK(found == doctest::Approx(stated).epsilon(0.06));
    }

    TEST_CASE("the confidence band contains the true density as often as it says") {
        std::size_t inside = 0, all = 0;
        for (unsigned k = 0; k < 400; ++k) {
            const Spectrum s = welch(white_noise(1024, 9000 + k), 1,
                                     {.segment = 128, .detrend = Detrend::nothing});
            const ConfidenceFactors f = confidence_factors(s.degrees_of_freedom, 0.9);
            for (std::size_t b = 4; b < 60; b += 8, ++all)
                inside += f.low * s.density[b] < 2 && 2 < f.high * s.density[b];
        }
        // 2800 nearly independent values: 3 standard deviations are 0.017
        CHECK(static_cast<double>(inside) / static_cast<double>(all) ==
              doctest::Approx(0.9).epsilon(0.02));
        const ConfidenceFactors f = confidence_factors(10, 0.95);
        CHECK(f.low == doctest::Approx(10 / 20.483177).epsilon(1e-6)); // tables of chi-squared
        CHECK(f.high == doctest::Approx(10 / 3.2469728).epsilon(1e-6));
    }

    TEST_CASE("runs without gaps are averaged, and a trend is removed") {
        const auto x = white_noise(4096, 4);
        const std::vector<std::vector<double>> halves{{x.begin(), x.begin() + 2048},
                                                      {x.begin() + 2048, x.end()}};
        const WelchSettings plain{.segment = 1024, .overlap = 0};
        const Spectrum whole = welch(x, 1, plain), parts = welch(halves, 1, plain);
        CHECK(parts.density == whole.density); // the same segments
        CHECK(parts.degrees_of_freedom == doctest::Approx(8));
        std::vector<double> line;
        for (int k = 0; k < 1000; ++k) line.push_back(3 - 0.02 * k);
        detrend(line, Detrend::line);
        CHECK(std::abs(*std::ranges::max_element(line)) < 1e-11);
    }

    TEST_CASE("what gives no spectrum is refused") {
        const std::vector<double> x(100, 1.0);
        CHECK_THROWS_AS((void)welch(x, 1, {.segment = 128}), InputError);
        CHECK_THROWS_AS((void)welch(x, 1, {.segment = 97}), InputError);
        CHECK_THROWS_AS((void)welch(x, 0, {.segment = 64}), InputError);
        CHECK_THROWS_AS((void)smoothed_periodogram(x, 1, {.half_width = 50}), InputError);
        CHECK(std::isnan(spectral_entropy(welch(x, 1, {.segment = 64}), 0.6, 0.9)));
    }
}
