#pragma once

#include <span>
#include <vector>

namespace bris {

/// Displacement (m) from acceleration (m/s2), sampled `rate` (Hz) times a second: the straight line
/// of least squares is subtracted, which is bias and drift of a sensor that rests at both ends, and
/// the rest is integrated twice in the frequency domain. Frequencies below `lowest` / 2 are left
/// out, and those up to `lowest` (Hz) are reduced by half a cosine wave, since noise grows with
/// 1/f^2. Slower motion and permanent displacement are lost. The ends are continued by zeros.
/// Throws InputError unless rate > 2 lowest > 0, or for fewer than 3 samples.
std::vector<double> displacement_of(std::span<const double> acceleration, double rate,
                                    double lowest);

/// What displacement_of finds of a displacement (m) that is known: the same without slow motion.
std::vector<double> without_slow_motion(std::span<const double> displacement, double rate,
                                        double lowest);

/// m, standard deviation of the noise of that displacement for a sensor whose mean over a time T
/// has the standard deviation `noise` / sqrt(T), noise in m/s2/sqrt(Hz).
double displacement_noise(double noise, double lowest);

/// The largest fall of a series from a local maximum to the minimum that follows it; rises of less
/// than `least` between them do not end a fall. 0 for a series that never falls.
double largest_fall(std::span<const double> series, double least);

} // namespace bris
