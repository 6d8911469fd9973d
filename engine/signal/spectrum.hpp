#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bris {

/// Series without gaps, of one quantity at one sampling rate.
using Runs = std::span<const std::vector<double>>;

enum class Window { rectangular, hann };
/// What is subtracted before the transform: nothing, the mean, or the line of least squares.
enum class Detrend { nothing, mean, line };

/// The values of a window of n samples, periodic: it continues with its first value.
std::vector<double> window_of(Window window, std::size_t n);
/// Equivalent noise bandwidth in bins, n sum w^2 / (sum w)^2: 1 for the rectangular window, 1.5 for
/// that of Hann.
double equivalent_noise_bandwidth(std::span<const double> window);
/// Subtracts the trend from the series.
void detrend(std::span<double> series, Detrend what);

/// Estimated one-sided spectral density of a series: its integral over frequency is the mean square
/// of the series.
struct Spectrum {
    std::size_t length = 0;           ///< samples in a transform
    double spacing = 0;               ///< Hz, between the bins
    double bandwidth = 0;             ///< Hz, resolution: equivalent noise bandwidth
    std::size_t segments = 0;         ///< number of transforms that were averaged
    double degrees_of_freedom = 0;    ///< of the chi-squared distribution of a value
    std::vector<double> density = {}; ///< squared unit of the series per Hz, bins 0 to length / 2
    double frequency(std::size_t bin) const { return spacing * static_cast<double>(bin); }
    /// Whether both signs of frequency are summed in a bin: not at 0 and at half the sampling rate.
    bool is_doubled(std::size_t bin) const { return bin > 0 && 2 * bin != length; }
};

/// The report's periodogram S_N = |X|^2 / N, with the transform X of the series, in the squared
/// unit of the series: bins 0 to N / 2; the others are their mirror image. Its sum over all N bins
/// is the sum of the squares of the series. Throws InputError for a length that is not fast (fft).
std::vector<double> periodogram(std::span<const double> series);

/// A periodogram of a series of `length` samples smoothed over frequency by the window of Daniell:
/// the mean of a bin and `half_width` neighbours on both sides, continued by the mirror image.
std::vector<double> smoothed_by_daniell(const std::vector<double>& periodogram, std::size_t length,
                                        std::size_t half_width);

struct SmoothingSettings {
    std::size_t half_width = 0; ///< of the window of Daniell, bins; 0: not smoothed
    Detrend detrend = Detrend::mean;
};
/// The report's definition as a density: the smoothed periodogram times 2 / rate, at 0 and at half
/// the sampling rate times 1 / rate. Degrees of freedom: Percival and Walden (1993), Spectral
/// Analysis for Physical Applications, eq. (264). `rate`: Hz. Throws InputError for a length that
/// is not fast.
Spectrum smoothed_periodogram(std::span<const double> series, double rate,
                              const SmoothingSettings& settings);

struct WelchSettings {
    std::size_t segment = 1024; ///< samples in a segment, a fast length (fft)
    double overlap = 0.5;       ///< of neighbouring segments, share in [0, 1)
    Window window = Window::hann;
    Detrend detrend = Detrend::mean; ///< of each segment
};
/// Density by the method of Welch (1967): the mean of |sum w x|^2 2 / (rate sum w^2) over the
/// segments that fit into the runs; what remains at the end of a run is left out. Degrees of
/// freedom: Percival and Walden (1993), eq. (292b), for segments of several runs. Throws InputError
/// if no segment fits.
Spectrum welch(Runs runs, double rate, const WelchSettings& settings = {});
Spectrum welch(const std::vector<double>& series, double rate, const WelchSettings& settings = {});

/// Factors on an estimated density between which the true one lies with this probability.
struct ConfidenceFactors {
    double low, high;
};
/// For degrees of freedom > 0: nu / chi^2 at (1 + probability) / 2 and at (1 - probability) / 2.
ConfidenceFactors confidence_factors(double degrees_of_freedom, double probability);

/// Mean square of the series in the bins with frequencies from `low` to `high` (Hz).
double band_power(const Spectrum& spectrum, double low, double high);
/// Entropy of the distribution of power over the bins from `low` to `high` (Hz), over that of white
/// noise: 1 for equal densities, 0 if all power is in one bin. NaN if there is no power, or fewer
/// than two bins.
double spectral_entropy(const Spectrum& spectrum, double low, double high);

} // namespace bris
