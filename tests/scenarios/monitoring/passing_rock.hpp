#pragma once

#include "scenarios/ballast_box/train.hpp"
#include "scenarios/recordings/recorded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace bris::testing {

/// Downward displacement (m) of a rock under a train: proportional to the load, with a hardening of
/// 20 % at 100 kN, and a settlement of 0.1 mm in the middle of the passage.
inline double displacement_under(const LoadHistory& load, double time) {
    constexpr double compliance = 1e-8; // m/N
    const double force = std::max(0.0, load.at(time)), half = 0.5 * load.times.back();
    return compliance * force / (1 + 0.2 * force / 100e3) +
           1e-4 / (1 + std::exp(-(time - half) / 0.5));
}

/// Its recording by a device (imu_preset), from a second before the load to a second after it.
inline Recording recording_under(const LoadHistory& load, const char* device, std::uint64_t seed,
                                 unsigned id = 1) {
    constexpr double h = 4e-3; // s
    InertialRecorder recorder{0, Imu(imu_preset(device), Vec3(0, 0, -9.81), seed, id), {}};
    const Quat tilted(Eigen::AngleAxisd(0.7, Vec3(1, 2, 0).normalized()));
    const double step = 1 / recorder.imu.model().rate;
    for (double t = -1; t < load.times.back() + 1; t += step) {
        const auto at = [&](double s) { return displacement_under(load, s); };
        const double down = (at(t - h) - 2 * at(t) + at(t + h)) / (h * h);
        recorder.samples.push_back(
            recorder.imu.sample(t, {.orientation = tilted, .acceleration = Vec3(0, 0, -down)}));
    }
    return recording_of(recorder, id, Vec3::Zero(), tilted);
}

} // namespace bris::testing
