#include "engine/signal/imu.hpp"

#include "engine/errors.hpp"

#include <string>

namespace bris {

namespace {

constexpr double g = 9.80665, degree = pi / 180;

} // namespace

ImuModel imu_preset(std::string_view name) {
    if (name == "ideal") return {};
    if (name == "lab-grade")
        return {.rate = 1000,
                .bandwidth = 400,
                .force_range = 16 * g,
                .rate_range = 2000 * degree,
                .bits = 20,
                .noise = {25e-6 * g, 2e-3 * degree, 5e-6 * g, 2e-4 * degree},
                .force_bias = 0.1e-3 * g,
                .rate_bias = 0.01 * degree,
                .scale_error = 5e-4,
                .misalignment = 0.02 * degree};
    if (name == "smartrock-like")
        return {.rate = 200,
                .bandwidth = 80,
                .force_range = 16 * g,
                .rate_range = 2000 * degree,
                .bits = 16,
                .noise = {100e-6 * g, 5e-3 * degree, 50e-6 * g, 1e-3 * degree},
                .force_bias = 1e-3 * g,
                .rate_bias = 0.1 * degree,
                .scale_error = 3e-3,
                .misalignment = 0.2 * degree,
                .clock_offset = 0.01,
                .clock_drift = 20e-6,
                .loss = 1e-3};
    if (name == "cheap")
        return {.rate = 100,
                .bandwidth = 40,
                .force_range = 8 * g,
                .rate_range = 1000 * degree,
                .bits = 12,
                .noise = {300e-6 * g, 10e-3 * degree, 200e-6 * g, 5e-3 * degree},
                .force_bias = 20e-3 * g,
                .rate_bias = 1 * degree,
                .scale_error = 1e-2,
                .misalignment = 1 * degree,
                .clock_offset = 0.1,
                .clock_drift = 100e-6,
                .loss = 1e-2};
    throw InputError(
        "inertial sensor: expected ideal, lab-grade, smartrock-like or cheap, found '" +
        std::string(name) + "'");
}

Imu::Imu(const ImuModel& model, const Vec3& gravity, std::uint64_t seed, std::uint64_t id)
    : model_(model), gravity_(gravity), random_(seed, id), force_distortion_(distortion()),
      rate_distortion_(distortion()), force_bias_(scatter(model.force_bias)),
      rate_bias_(scatter(model.rate_bias)) {
    require(model.rate > 0, "inertial sensor: expected a sampling rate above 0");
}

Mat3 Imu::distortion() {
    const Vec3 scale = scatter(model_.scale_error), tilt = scatter(model_.misalignment);
    return Mat3::Identity() + Mat3(scale.asDiagonal()) + cross_matrix(tilt);
}

Vec3 Imu::passed(Vec3& memory, const Vec3& value) const {
    if (model_.bandwidth <= 0) return value;
    if (sequence_ == 0) return memory = value;
    return memory = value + std::exp(-2 * pi * model_.bandwidth / model_.rate) * (memory - value);
}

Vec3 Imu::digits(const Vec3& value, double range, bool& saturated) const {
    if (range <= 0) return value;
    const Vec3 held = value.cwiseMax(-range).cwiseMin(range);
    saturated = saturated || held != value;
    if (model_.bits == 0) return held;
    const double step = range / std::exp2(model_.bits - 1.0);
    return (held / step).array().round().matrix() * step;
}

ImuSample Imu::sample(double time, const TrueMotion& motion) {
    const double dt = 1 / model_.rate;
    const Quat to_body = motion.orientation.conjugate(), to_sensor = model_.mounting.conjugate();
    const Vec3 angular_velocity = to_body * motion.angular_velocity,
               twist = to_body * motion.angular_acceleration;
    const Vec3 force = to_body * Vec3(motion.acceleration - gravity_) + twist.cross(model_.arm) +
                       angular_velocity.cross(angular_velocity.cross(model_.arm));
    ImuSample s{.time = time * (1 + model_.clock_drift) + model_.clock_offset};
    const Vec3 seen_force = passed(force_memory_, force_distortion_ * (to_sensor * force));
    const Vec3 seen_rate = passed(rate_memory_, rate_distortion_ * (to_sensor * angular_velocity));
    force_bias_ += scatter(model_.noise.force_bias_walk * std::sqrt(dt));
    rate_bias_ += scatter(model_.noise.rate_bias_walk * std::sqrt(dt));
    s.force = digits(seen_force + force_bias_ + scatter(model_.noise.force / std::sqrt(dt)),
                     model_.force_range, s.saturated);
    s.rate = digits(seen_rate + rate_bias_ + scatter(model_.noise.rate / std::sqrt(dt)),
                    model_.rate_range, s.saturated);
    s.lost = random_.uniform() < model_.loss;
    s.sequence = sequence_++;
    return s;
}

} // namespace bris
