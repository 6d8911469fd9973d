#pragma once

#include "scenarios/monitoring/synthetic_vibration.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// Trains of a line, and what every rock would feel: the one truth on which strategies are
/// compared.
struct TruthSettings {
    double duration = 86400;              ///< s of the whole simulation
    double headway = 3600;                ///< s between planned arrivals
    double delay = 60;                    ///< s, standard deviation of arrivals about the timetable
    double passage = 20;                  ///< s that a train takes
    double change_time = 43200;           ///< s from which the ballast is in the changed state
    std::string changed_state = "fouled"; ///< synthetic_state
    double noise = 0.014;                 ///< m/s2, standard deviation of a sample at 200 Hz
    std::filesystem::path timetable = {}; ///< CSV file: planned_s, and arrival_s if known
};

struct ScheduledTrain {
    double planned = 0, arrival = 0; ///< s
    bool changed = false;            ///< whether the ballast has changed when it passes
};

/// Synthetic vertical acceleration of rocks under trains (synthetic_vibration) at `base_rate`.
/// Between trains there is only the noise of the device.
class Truth {
public:
    static constexpr double base_rate = 400; ///< Hz

    /// Throws InputError with file:line for a wrong timetable.
    Truth(const TruthSettings& settings, std::uint64_t seed);
    const TruthSettings& settings() const { return settings_; }
    const std::vector<ScheduledTrain>& trains() const { return trains_; }
    /// Number of the base sample at which the signal of a train begins, and its length in samples.
    std::uint64_t first_sample(std::size_t train) const;
    std::uint64_t samples_per_train() const;
    /// True acceleration (m/s2) of a rock under a train, at the base rate. Computed anew at each
    /// call; any thread may call it.
    std::vector<double> signal(unsigned rock, std::size_t train) const;
    /// The trains whose signals overlap the base samples from `first` to before `end`: a range of
    /// indices.
    std::pair<std::size_t, std::size_t> trains_within(std::uint64_t first, std::uint64_t end) const;
    /// Standard deviation of the noise in a mean over base_rate / rate base samples.
    double noise_of_sample(double rate) const;
    std::uint64_t seed() const { return seed_; }

private:
    TruthSettings settings_;
    SyntheticVibration vibration_;
    std::uint64_t seed_;
    std::vector<ScheduledTrain> trains_;
};

/// What the device of one rock measures. Keeps the signal of the train asked for last.
class RockSignal {
public:
    RockSignal(const Truth& truth, unsigned rock) : truth_(truth), rock_(rock) {}
    const std::vector<double>& of_train(std::size_t train);
    /// `count` samples from base sample `first` on: means over base_rate / rate base samples, plus
    /// the noise of the device. `rate` divides the base rate.
    std::vector<double> measured(std::uint64_t first, std::size_t count, double rate);

private:
    const Truth& truth_;
    unsigned rock_;
    std::size_t train_ = std::numeric_limits<std::size_t>::max();
    std::vector<double> signal_;
};

/// Checks that a sampling rate divides the base rate. Throws InputError naming `what`.
void require_sampling_rate(double rate, const std::string& what);

} // namespace bris
