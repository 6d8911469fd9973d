#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bris {

/// A series, sampled `rate` (Hz) times a second and continued by zeros, without frequencies below
/// `lowest` / 2, and with those up to `lowest` (Hz) reduced by half a cosine wave; with
/// `derivatives` 2 also differentiated twice. It is as long as the series. Throws InputError unless
/// rate > 2 lowest > 0, for fewer than 3 samples and for other derivatives than 0 and 2.
std::vector<double> without_slow_part(std::span<const double> series, double rate, double lowest,
                                      int derivatives = 0);

/// How much of a known shape is in a series.
struct MatchedShape {
    double factor = 0;    ///< on the shape, by least squares
    double deviation = 0; ///< standard deviation of the factor
    long lag = 0;         ///< samples by which the shape begins later than the series
};
/// At the lag from -`reach` to `reach` samples where both correlate most. The deviation follows
/// from the spectrum of what is left of the series around the frequencies that the shape has, sum
/// |S|^2 |R|^2 / (sum |S|^2)^2 (smoothed over an octave), so that it counts noise of any colour and
/// what makes the series differ in shape. Throws InputError if the series is shorter than 3
/// samples, or if the shape is zero.
MatchedShape match_shape(std::span<const double> series, std::span<const double> shape, long reach);

} // namespace bris
