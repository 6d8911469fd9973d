#pragma once

#include "engine/signal/fft.hpp"
#include "scenarios/ballast_box/train.hpp"

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// A train that passes at a constant speed over a tie.
struct PassingTrain {
    Train train;
    double speed;     ///< m/s
    RailOnTies rails; ///< that distribute its load
    double dead_load; ///< N, of rails and fastenings on the tie
};

/// m, of a pattern along the track between two of its numbers.
inline constexpr double pattern_spacing = 0.05;

/// An acceleration (m/s2, `rate` Hz) to which the second derivatives of patterns are matched,
/// without what lies below `lowest` (Hz) and above so many wave numbers of the rails at the stated
/// speed. Patterns are tried at all lags from half a second before the series to half a second
/// after its end, and at speeds within 5 % of the stated one.
class PatternMatching {
public:
    PatternMatching(std::span<const double> acceleration, double rate, const PassingTrain& passing,
                    double lowest, double wave_numbers);

    double band() const { return static_cast<double>(series_.size()) / period_; } ///< Hz
    double power() const { return power_; } ///< of the series, in no unit; NaN if it is not finite

    /// A pattern at the lag (s) and speed (m/s) at which it fits best: it explains that share of
    /// the power of the series if its factor is free.
    struct Match {
        double goodness = 0, speed = 0, lag = 0;
    };
    Match best(const std::vector<double>& pattern) const;
    /// Share of the power that a pattern (m) leaves at this speed and the best lag, as it is: above
    /// 1 if it is too large or none that fits.
    double left_by(const std::vector<double>& pattern, double speed) const;

    /// Why the series is not the train that matches it, from what single parts of it say; empty if
    /// they agree.
    std::string contradiction(const std::vector<double>& pattern, const Match& match) const;

private:
    using Spectrum = std::vector<std::complex<double>>;
    struct Lagged {
        double product = 0, lag = 0; // of series and pattern; s
    };

    double kept(std::size_t k) const;
    static double duration_of(const std::vector<double>& pattern, double speed) {
        return static_cast<double>(pattern.size()) * pattern_spacing / speed;
    }
    Spectrum spectrum_of(const std::vector<double>& pattern, double speed) const;
    std::vector<double> in_time(Spectrum spectrum) const;
    double time_of(std::size_t sample) const;
    Lagged best_lag(const Spectrum& pattern, double lasts) const;

    double duration_, lowest_, period_ = 0, power_ = 0; // s, Hz, s
    Spectrum series_;
    std::vector<double> weights_; // of frequencies in the second derivative of a pattern
    std::size_t length_ = 0;      // samples of a period of the series
    std::size_t short_ = 0;       // samples of a period that hold the band twice over
    std::unique_ptr<Fft> fft_;
    std::vector<double> speeds_;
};

} // namespace bris
