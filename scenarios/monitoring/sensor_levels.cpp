#include "scenarios/monitoring/sensor_levels.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

Spectrum spectrum_of_longest(const Vibration& vertical) {
    if (vertical.runs.empty()) return {};
    const std::size_t longest =
        std::ranges::max(vertical.runs, {}, [](const auto& run) { return run.size(); }).size();
    WelchSettings settings;
    while (settings.segment > 64 && 2 * settings.segment > longest) settings.segment /= 2;
    return 2 * settings.segment > longest ? Spectrum{}
                                          : welch(vertical.runs, vertical.rate, settings);
}

void add_sensor_levels(Report& summary, const std::string& prefix, const std::string& name,
                       const Recording& recording, double load_band) {
    const Vibration vertical = vibration_of(recording, VibrationQuantity::vertical, 0.1);
    require(vertical.impossible_because.empty(), vertical.impossible_because);
    double peak = 0;
    for (const auto& run : vertical.runs)
        for (const double a : run) peak = std::max(peak, std::abs(a));
    summary.add(prefix + "vertical_rms_" + name + "_m_per_s2", vertical.rms);
    summary.add(prefix + "vertical_peak_" + name + "_m_per_s2", peak);
    for (const auto rate :
         {VibrationQuantity::roll_rate, VibrationQuantity::pitch_rate, VibrationQuantity::yaw_rate})
        summary.add(fmt::format("{}{}_rms_{}_rad_per_s", prefix, text_of(rate), name),
                    vibration_of(recording, rate, 0.1).rms);
    const Spectrum spectrum = spectrum_of_longest(vertical);
    if (spectrum.density.empty()) return;
    summary.add(prefix + "vertical_rms_following_load_" + name + "_m_per_s2",
                std::sqrt(band_power(spectrum, 0, load_band)));
    summary.add(prefix + "vertical_rms_of_rest_" + name + "_m_per_s2",
                std::sqrt(band_power(spectrum, load_band + spectrum.spacing,
                                     spectrum.frequency(spectrum.density.size()))));
    for (const auto& [low, high] : {std::pair{1, 5}, {5, 20}, {20, 80}})
        summary.add(
            fmt::format("{}vertical_power_{}_to_{}_Hz_{}_m2_per_s4", prefix, low, high, name),
            band_power(spectrum, low, high));
    summary.add(prefix + "vertical_entropy_" + name, spectral_entropy(spectrum, 1, 80));
}

} // namespace bris
