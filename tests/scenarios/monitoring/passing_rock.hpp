#pragma once

#include "scenarios/ballast_box/train.hpp"
#include "scenarios/specimens/recorded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace bris::testing {

/// Downward displacement (m) of a rock under a load (N): 10 um/kN, with a hardening of 20 % at
/// 100 kN.
inline double hardening_displacement(double load) {
    const double force = std::max(0.0, load);
    return 1e-8 * force / (1 + 0.2 * force / 100e3);
}

/// The recording of such a rock by a device (imu_preset) under a train, or of what has another
/// `displacement` (m, downwards) under that load, from `early` + 1 s before the load to a second
/// after it. It settles by 0.1 mm and tilts by `tilt` (rad) in the middle of the passage.
inline Recording recording_under(const LoadHistory& load, const char* device, std::uint64_t seed,
                                 unsigned id = 1, double tilt = 0, double early = 0,
                                 double (*displacement)(double) = hardening_displacement) {
    constexpr double h = 4e-3; // s
    const double half = 0.5 * load.times.back();
    const auto share = [&](double t) { return 1 / (1 + std::exp(-(t - half) / 0.3)); };
    const auto height = [&](double t) { return -displacement(load.at(t)) - 1e-4 * share(t); };
    RecordingImu recorder{Imu(imu_preset(device), Vec3(0, 0, -9.81), seed, id)};
    const Quat tilted(Eigen::AngleAxisd(0.7, Vec3(1, 2, 0).normalized()));
    const double step = 1 / recorder.imu.model().rate;
    for (double t = -1 - early; t < load.times.back() + 1; t += step) {
        const double up = (height(t - h) - 2 * height(t) + height(t + h)) / (h * h),
                     turning = tilt * (share(t + h) - share(t - h)) / (2 * h);
        recorder.samples.push_back(recorder.imu.sample(
            t, {.orientation = Quat(Eigen::AngleAxisd(tilt * share(t), Vec3::UnitX())) * tilted,
                .acceleration = Vec3(0, 0, up),
                .angular_velocity = Vec3(turning, 0, 0)}));
    }
    return recording_of(recorder, id, Vec3::Zero(), tilted);
}

} // namespace bris::testing
