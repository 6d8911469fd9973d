#pragma once

#include "engine/archive.hpp"
#include "engine/math.hpp"
#include "engine/random_vector.hpp"
#include "engine/signal/true_motion.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Noise densities of an inertial sensor: white noise of its samples, and of the random walk of its
/// biases.
struct InertialNoise {
    double force = 0, rate = 0;                     ///< m/s2/sqrt(Hz), rad/s/sqrt(Hz)
    double force_bias_walk = 0, rate_bias_walk = 0; ///< m/s3/sqrt(Hz), rad/s2/sqrt(Hz)
};

/// Specification of an inertial sensor: three accelerometers and three gyroscopes. Noise densities
/// are those of the mean over a time T, whose standard deviation is density / sqrt(T).
struct ImuModel {
    double rate = 200;    ///< Hz
    double bandwidth = 0; ///< Hz, of a first-order low pass before sampling; 0: no low pass
    double force_range = 0, rate_range = 0; ///< m/s2 and rad/s, largest value; 0: no limit
    unsigned bits = 0; ///< of a sample over the range -range to range; 0: not rounded
    InertialNoise noise;
    /// Standard deviations of the turn-on biases (m/s2 and rad/s).
    double force_bias = 0, rate_bias = 0;
    /// Standard deviations from device to device, relative and in rad.
    double scale_error = 0, misalignment = 0;
    Vec3 arm = Vec3::Zero();                  ///< m, from the body's centre, in body axes
    Quat mounting = Quat::Identity();         ///< from the sensor's axes to the body's
    double clock_offset = 0, clock_drift = 0; ///< s, and s per second: of the time stamps
    double loss = 0;                          ///< fraction of samples that never arrive
};

/// Specification of a class of devices: "ideal" (no errors), "lab-grade", "smartrock-like" or
/// "cheap". Common devices have a noise of 60-300 micro-g and 4-10 mdeg/s per root hertz, and
/// biases that remain after calibration at rest. Throws InputError for any other name.
ImuModel imu_preset(std::string_view name);
inline constexpr std::array<std::string_view, 4> imu_presets{"ideal", "lab-grade", "smartrock-like",
                                                             "cheap"};

/// The same device without errors: with the rate, low pass, place and axes only.
ImuModel without_errors(const ImuModel& model);

struct ImuSample {
    double time = 0; ///< s, on the sensor's own clock
    std::uint64_t sequence = 0;
    Vec3 force = Vec3::Zero(), rate = Vec3::Zero(); ///< m/s2 and rad/s, in the sensor's axes
    bool saturated = false, lost = false;
};

/// One device, with its own biases, scale factors and misalignments, drawn from (seed, id)
/// independently of all other draws. Order of effects: lever arm, axes, scale and misalignment, low
/// pass, bias and its random walk, noise, range, rounding, time stamp, loss.
class Imu {
public:
    Imu(const ImuModel& model, const Vec3& gravity, std::uint64_t seed, std::uint64_t id);
    /// The next sample, at the true time `time` (s); called once every 1 / rate seconds. The low
    /// pass acts on samples.
    ImuSample sample(double time, const TrueMotion& motion) {
        sense(1 / model_.rate, motion);
        return read(time);
    }
    /// The two halves of `sample`. `sense` lets the low pass follow the motion for `dt` seconds,
    /// so that it acts before sampling if it is called more often; `read` takes the next sample.
    void sense(double dt, const TrueMotion& motion);
    ImuSample read(double time);

    const ImuModel& model() const { return model_; }
    /// What changes from sample to sample, as arrays whose path begins with `path`.
    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);
    Vec3 force_bias() const { return force_bias_; }
    Vec3 rate_bias() const { return rate_bias_; }

private:
    Vec3 scatter(double deviation) { return deviation * normal_vector(random_); }
    Mat3 distortion();
    Vec3 passed(const Vec3& memory, const Vec3& value, double dt) const;
    Vec3 digits(const Vec3& value, double range, bool& saturated) const;

    ImuModel model_;
    Vec3 gravity_;
    Random random_;
    Mat3 force_distortion_, rate_distortion_;
    Vec3 force_bias_, rate_bias_, force_memory_ = Vec3::Zero(), rate_memory_ = Vec3::Zero();
    std::uint64_t sequence_ = 0;
    bool sensed_ = false; ///< the low pass has a value
};

} // namespace bris
