#include "engine/signal/imu.hpp"

#include "engine/errors.hpp"
#include "engine/signal/attitude.hpp"

#include <string>

namespace bris {

namespace {

constexpr double g = 9.80665, degree = pi / 180;

} // namespace

ImuModel without_errors(const ImuModel& model) {
    ImuModel exact = imu_preset("ideal");
    exact.rate = model.rate;
    exact.bandwidth = model.bandwidth;
    exact.arm = model.arm;
    exact.mounting = model.mounting;
    return exact;
}

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

Vec3 Imu::passed(const Vec3& memory, const Vec3& value, double dt) const {
    if (model_.bandwidth <= 0 || !sensed_) return value;
    return value + std::exp(-2 * pi * model_.bandwidth * dt) * (memory - value);
}

Vec3 Imu::digits(const Vec3& value, double range, bool& saturated) const {
    if (range <= 0) return value;
    const Vec3 held = value.cwiseMax(-range).cwiseMin(range);
    saturated = saturated || held != value;
    if (model_.bits == 0) return held;
    const double step = range / std::exp2(model_.bits - 1.0);
    return (held / step).array().round().matrix() * step;
}

void Imu::sense(double dt, const TrueMotion& motion) {
    const Quat to_body = motion.orientation.conjugate(), to_sensor = model_.mounting.conjugate();
    const Vec3 angular_velocity = to_body * motion.angular_velocity,
               twist = to_body * motion.angular_acceleration;
    const Vec3 force = to_body * Vec3(motion.acceleration - gravity_) + twist.cross(model_.arm) +
                       angular_velocity.cross(angular_velocity.cross(model_.arm));
    force_memory_ = passed(force_memory_, force_distortion_ * (to_sensor * force), dt);
    rate_memory_ = passed(rate_memory_, rate_distortion_ * (to_sensor * angular_velocity), dt);
    sensed_ = true;
}

ImuSample Imu::read(double time) {
    const double dt = 1 / model_.rate;
    ImuSample s{.time = time * (1 + model_.clock_drift) + model_.clock_offset};
    force_bias_ += scatter(model_.noise.force_bias_walk * std::sqrt(dt));
    rate_bias_ += scatter(model_.noise.rate_bias_walk * std::sqrt(dt));
    s.force = digits(force_memory_ + force_bias_ + scatter(model_.noise.force / std::sqrt(dt)),
                     model_.force_range, s.saturated);
    s.rate = digits(rate_memory_ + rate_bias_ + scatter(model_.noise.rate / std::sqrt(dt)),
                    model_.rate_range, s.saturated);
    s.lost = random_.uniform() < model_.loss;
    s.sequence = sequence_++;
    return s;
}

void Imu::save(Archive& archive, const std::string& path) const {
    std::vector<double> values;
    for (const Vec3* v : {&force_bias_, &rate_bias_, &force_memory_, &rate_memory_})
        values.insert(values.end(), v->data(), v->data() + 3);
    archive.put(path + "/values", std::span<const double>(values));
    const std::array<std::uint64_t, 3> counts{random_.draws(), sequence_, sensed_ ? 1u : 0u};
    archive.put(path + "/counts", std::span<const std::uint64_t>(counts));
}

void Imu::load(const Archive& archive, const std::string& path) {
    const auto values = archive.get<double>(path + "/values");
    std::size_t next = 0;
    for (Vec3* v : {&force_bias_, &rate_bias_, &force_memory_, &rate_memory_})
        for (int k = 0; k < 3; ++k) (*v)[k] = values.at(next++);
    const auto counts = archive.get<std::uint64_t>(path + "/counts");
    random_.continue_at(counts.at(0));
    sequence_ = counts.at(1);
    sensed_ = counts.at(2) != 0;
}

} // namespace bris
