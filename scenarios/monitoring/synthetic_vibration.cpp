#include "scenarios/monitoring/synthetic_vibration.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/signal/autoregression.hpp"
#include "engine/signal/imu.hpp"
#include "engine/signal/roll_pitch_yaw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double bell = 0.06; // s, standard deviation of the bell curve of a bogie pair

/// Product of the polynomials 1 - sum a_i z^i of two models.
std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> c(a.size() + b.size(), 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) c[i] += a[i];
    for (std::size_t j = 0; j < b.size(); ++j) c[j] += b[j];
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) c[i + j + 1] -= a[i] * b[j];
    return c;
}

std::vector<double> resonance(double frequency, double radius, double rate) {
    return {2 * radius * std::cos(2 * pi * frequency / rate), -radius * radius};
}

/// The model with innovations such that its process has the variance 1.
ArModel standardised(std::vector<double> coefficients) {
    ArModel model{.coefficients = std::move(coefficients), .variance = 1};
    model.variance = 1 / autocovariances_of(model, 0).front();
    return model;
}

/// Number of a stream of random draws of one sensor in one passage.
std::uint64_t stream_of(unsigned passage, unsigned sensor, unsigned quantity) {
    return (std::uint64_t{passage} << 32) | (std::uint64_t{sensor} << 8) | quantity;
}

class Motion {
public:
    Motion(const SyntheticVibration& s, const SyntheticState& state, std::uint64_t seed,
           unsigned passage, unsigned sensor)
        : s_(s) {
        const double scale = 200 / s.rate; // pole radii are those at 200 Hz
        const ArModel vibration =
            standardised(product(resonance(22 * state.frequency, std::pow(0.95, scale), s.rate),
                                 resonance(58 * state.frequency, std::pow(0.90, scale), s.rate)));
        const ArModel rotation =
            standardised(resonance(6 * state.frequency, std::pow(0.96, scale), s.rate));
        for (unsigned k = 0; k < 6; ++k)
            processes_.emplace_back(k < 3 ? vibration : rotation, seed,
                                    stream_of(passage, sensor, k));
        Random of_sensor(seed, stream_of(0, sensor, 100)),
            of_passage(seed, stream_of(passage, 0, 101)),
            of_both(seed, stream_of(passage, sensor, 102));
        // half of the variance from passage to passage is common to all sensors: the train's load
        level_ = state.level * std::exp(s.sensor_scatter * of_sensor.normal() +
                                        s.passage_scatter * std::sqrt(0.5) *
                                            (of_passage.normal() + of_both.normal()));
        roll_ = 0.5 * state.roll;
        phase_ = of_passage.uniform() * s.bogie_interval;
    }

    struct At {
        Vec3 acceleration;
        RollPitchYaw angles;
    };
    At next(double t) {
        std::array<double, 6> x{};
        for (std::size_t k = 0; k < 6; ++k) x[k] = processes_[k].next();
        const double passing = envelope(t), v = level_ * s_.level * passing,
                     angle = level_ * s_.rotation * passing;
        return {{0.4 * v * x[0], 0.4 * v * x[1], v * x[2] + level_ * pulse(t)},
                {roll_ * angle * x[3], angle * x[4], angle * x[5]}};
    }

private:
    /// Calls visit(time since the nearest bogie pair) for the bogie pairs around t.
    double sum_over_bogies(double t, auto&& visit) const {
        double sum = 0;
        const double end = s_.lead + s_.duration - 0.3;
        for (double at = s_.lead + 0.3 + phase_; at < end; at += s_.bogie_interval)
            if (std::abs(t - at) < 6 * bell) sum += visit((t - at) / bell);
        return sum;
    }
    double envelope(double t) const {
        const double in = (t - s_.lead) / 0.2, out = (s_.lead + s_.duration - t) / 0.2;
        const double passing = std::clamp(std::min(in, out), 0.0, 1.0);
        return passing *
               (1 + 0.5 * sum_over_bogies(t, [](double u) { return std::exp(-0.5 * u * u); }));
    }
    double pulse(double t) const {
        return s_.pulse *
               sum_over_bogies(t, [](double u) { return (u * u - 1) * std::exp(-0.5 * u * u); });
    }

    const SyntheticVibration& s_;
    std::vector<ArSeries> processes_;
    double level_ = 1, roll_ = 0.5, phase_ = 0;
};

SensorInfo info_of(const SyntheticVibration& s, const ImuModel& model, std::uint64_t seed,
                   unsigned sensor) {
    SensorInfo info;
    info.id = sensor;
    Random random(seed, stream_of(0, sensor, 103));
    info.set_pose(Vec3(0.6 * sensor, 0, -0.15), random.rotation());
    info.sampling_rate = s.rate;
    info.force_range = model.force_range > 0 ? model.force_range : 160;
    info.rate_range = model.rate_range > 0 ? model.rate_range : 35;
    info.force_noise = model.noise.force;
    info.rate_noise = model.noise.rate;
    info.force_bias = std::max(1e-3, 3 * model.force_bias);
    info.rate_bias = std::max(1e-4, 3 * model.rate_bias);
    return info;
}

std::size_t samples_in(const SyntheticVibration& s) {
    return static_cast<std::size_t>(std::lround((s.duration + 2 * s.lead) * s.rate));
}

Recording recording_of(const SyntheticVibration& s, const SyntheticState& state, std::uint64_t seed,
                       unsigned passage, unsigned sensor) {
    ImuModel model = imu_preset(s.device);
    model.rate = s.rate;
    Recording r;
    r.info = info_of(s, model, seed, sensor);
    const Vec3 gravity(0, 0, -9.81);
    Imu device(model, gravity, seed, stream_of(passage, sensor, 104));
    Motion motion(s, state, seed, passage, sensor);
    const Quat start = r.info.attitude();
    const std::size_t samples = samples_in(s);
    Quat before = start;
    Vec3 rate_before = Vec3::Zero();
    for (std::size_t k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) / s.rate;
        const Motion::At now = motion.next(t);
        const Quat q = quaternion_of(now.angles) * start;
        const Vec3 rate = attitude_error(q, before) * s.rate;
        const ImuSample sample =
            device.sample(t, {.orientation = q,
                              .acceleration = now.acceleration,
                              .angular_velocity = rate,
                              .angular_acceleration = (rate - rate_before) * s.rate});
        before = q;
        rate_before = rate;
        if (sample.lost) continue;
        r.time.push_back(sample.time);
        r.sequence.push_back(sample.sequence);
        r.force.push_back(r.info.mounting() * sample.force);
        r.rate.push_back(r.info.mounting() * sample.rate);
    }
    return r;
}

} // namespace

SyntheticState synthetic_state(std::string_view name) {
    if (name == "clean") return {};
    if (name == "fouled") return {.level = 2, .roll = 2};
    if (name == "loosened") return {.frequency = 0.75};
    throw InputError(
        fmt::format("synthetic state: expected clean, fouled or loosened, found '{}'", name));
}

Passage synthetic_passage(const SyntheticVibration& settings, const SyntheticState& state,
                          std::uint64_t seed, unsigned passage, const std::string& name) {
    Passage p{name, {}};
    for (unsigned sensor = 1; sensor <= settings.sensors; ++sensor)
        p.recordings.push_back(recording_of(settings, state, seed, passage, sensor));
    return p;
}

std::vector<double> synthetic_vertical(const SyntheticVibration& settings,
                                       const SyntheticState& state, std::uint64_t seed,
                                       unsigned passage, unsigned sensor) {
    Motion motion(settings, state, seed, passage, sensor);
    std::vector<double> series;
    const auto samples = samples_in(settings);
    for (std::size_t k = 0; k < samples; ++k)
        series.push_back(motion.next(static_cast<double>(k) / settings.rate).acceleration.z());
    return series;
}

} // namespace bris
