#include "engine/estimation/smoother.hpp"
#include "systems/fusion/sensor_filter.hpp"

#include <algorithm>

namespace bris {

namespace {

constexpr double same_time = 1e-9; // relative: times and strains are sums of steps

RigidState between(const RigidState& a, const RigidState& b, double share) {
    return {
        .position = a.position + share * (b.position - a.position),
        .velocity = a.velocity + share * (b.velocity - a.velocity),
        .orientation =
            (exponential_map(share * attitude_error(b.orientation, a.orientation)) * a.orientation)
                .normalized(),
        .angular_velocity = a.angular_velocity + share * (b.angular_velocity - a.angular_velocity)};
}

/// Calls visit(number) for all numbers of a part of a snapshot, to read or write them.
void visit_numbers(auto& s, auto&& visit) requires requires {
    s.angular_velocity;
    s.orientation;
}
{
    for (auto* v : {&s.position, &s.velocity, &s.angular_velocity})
        for (int k = 0; k < 3; ++k) visit((*v)[k]);
    for (int k = 0; k < 4; ++k) visit(s.orientation.coeffs()[k]);
}
void visit_numbers(auto& m, auto&& visit) requires requires { m.up; }
{
    for (auto* v : {&m.position, &m.velocity, &m.angular_velocity, &m.up})
        for (int k = 0; k < 3; ++k) visit((*v)[k]);
    for (int k = 0; k < 4; ++k) visit(m.attitude.coeffs()[k]);
    for (auto* d : {&m.position_deviation, &m.velocity_deviation, &m.angular_velocity_deviation,
                    &m.attitude_deviation})
        visit(*d);
}
void visit_numbers(auto& snapshot, auto&& visit) requires requires { snapshot.given; }
{
    visit(snapshot.forecast.time);
    visit_numbers(snapshot.forecast.state, visit);
    visit_numbers(snapshot.measured, visit);
    visit_numbers(snapshot.estimate, visit);
    visit_numbers(snapshot.given, visit);
    for (int k = 0; k < snapshot.root.size(); ++k) visit(snapshot.root.data()[k]);
}

bool is_same(const RigidState& a, const RigidState& b) {
    return a.position == b.position && a.velocity == b.velocity &&
           a.orientation.coeffs() == b.orientation.coeffs() &&
           a.angular_velocity == b.angular_velocity;
}

} // namespace

// State of a body at the time of `later` if it had continued from `estimate` instead of `given`,
// with the motion that was simulated in between.
RigidState SensorFilter::carried(const RigidState& estimate, const RigidState& given,
                                 const RigidState& later, double dt) {
    if (is_same(estimate, given)) return later;
    const Vec3 dv = estimate.velocity - given.velocity,
               dw = estimate.angular_velocity - given.angular_velocity;
    RigidState s = later;
    s.position += estimate.position - given.position + dt * dv;
    s.velocity += dv;
    s.orientation =
        (exponential_map(attitude_error(later.orientation, given.orientation) + dt * dw) *
         estimate.orientation)
            .normalized();
    s.angular_velocity += dw;
    return s;
}

void SensorFilter::remember(const Snapshot& snapshot) {
    window_.push_back(snapshot);
    if (window_.size() > settings_.lag + 1) window_.erase(window_.begin());
}

void SensorFilter::note(const BodyForecast& now) {
    if (!remembers() || (begun_ && now.time <= last_time_ + same_time * std::abs(now.time))) return;
    (void)update(now, {});
    window_.back().given = now.state; // no correction is applied
}

void SensorFilter::go_back_to(const Snapshot& snapshot) {
    Gaussian error = filter_.error();
    error.root = snapshot.root;
    filter_.restore(error);
    filter_.state = snapshot.estimate;
}

Analysis SensorFilter::update_again(std::size_t k) {
    const Snapshot& before = window_[k - 1];
    Snapshot& s = window_[k];
    const double dt = s.forecast.time - before.forecast.time;
    go_back_to(before);
    move_on(dt, carried(before.estimate, before.given, s.forecast.state, dt));
    const Analysis a = observe(s.measured);
    s.estimate = filter_.state;
    s.root = filter_.error().root;
    return a;
}

std::optional<Analysis> SensorFilter::update_late(double time, const Measured& measured) {
    const double same = same_time * std::abs(time);
    const auto after =
        std::upper_bound(window_.begin(), window_.end(), time + same,
                         [](double t, const Snapshot& s) { return t < s.forecast.time; });
    if (after == window_.begin()) return {};
    auto k = static_cast<std::size_t>(after - window_.begin());
    Snapshot& before = window_[k - 1];
    Analysis a;
    // the motion was stored at this same time
    if (before.measured.is_empty() && before.forecast.time >= time - same) {
        before.measured = measured;
        go_back_to(before);
        a = observe(measured);
        before.estimate = filter_.state;
        before.root = filter_.error().root;
    } else {
        Snapshot late{{std::max(time, before.forecast.time), before.given}, measured, {}, {}, {}};
        if (after != window_.end()) {
            const double gap = after->forecast.time - before.forecast.time;
            late.forecast.state =
                between(before.given, after->forecast.state,
                        gap > 0 ? (late.forecast.time - before.forecast.time) / gap : 0);
        }
        late.given = late.forecast.state;
        window_.insert(after, late);
        a = update_again(k++);
    }
    const AnalysisStatistics position = position_, attitude = attitude_; // of the late measurement
    for (; k < window_.size(); ++k) (void)update_again(k);
    position_ = position;
    attitude_ = attitude;
    Snapshot& now = window_.back();
    Analysis correction = difference(now.estimate, now.given);
    correction.accepted = a.accepted;
    correction.refused = a.refused;
    correction.largest_distance = a.largest_distance;
    now.given = now.estimate;
    if (window_.size() > settings_.lag + 1) window_.erase(window_.begin());
    return correction;
}

// Transition and noise that move_on() has applied to the covariance.
Transition SensorFilter::transition(double dt, const Vec3& angular_velocity) const {
    Transition t{Matrix::Identity(12, 12), Matrix::Zero(12, 12)};
    if (dt > 0) {
        const Transition free =
            InertialFilter::free_motion(dt, angular_velocity, settings_.acceleration_density,
                                        settings_.angular_acceleration_density);
        t = {free.F.topLeftCorner<12, 12>(), free.Q.topLeftCorner<12, 12>()};
    }
    t.Q.diagonal().head<3>().array() += settings_.drift * dt;
    t.Q.diagonal().segment<3>(6).array() += settings_.turning * dt;
    return t;
}

// The smoother works on errors of the forecasts, whose predicted mean is 0.
std::vector<SmoothedPose> SensorFilter::smoothed() const {
    std::vector<FilterStep> steps;
    std::vector<RigidState> forecasts;
    for (std::size_t k = 0; k < window_.size(); ++k) {
        const Snapshot& s = window_[k];
        FilterStep step;
        forecasts.push_back(s.forecast.state);
        if (k > 0) {
            const Snapshot& before = window_[k - 1];
            const double dt = s.forecast.time - before.forecast.time;
            forecasts.back() = carried(before.estimate, before.given, s.forecast.state, dt);
            step.transition = transition(dt, before.estimate.angular_velocity);
            step.predicted = predict(steps.back().corrected, step.transition);
            step.predicted.mean.setZero();
        }
        const Analysis known = difference(s.estimate, forecasts.back());
        step.corrected = Gaussian(12);
        step.corrected.mean << known.shift, known.velocity, known.turn, known.angular_velocity;
        // the corner of a lower triangle is the root of the corner of its covariance
        step.corrected.root = s.root.topLeftCorner<12, 12>();
        steps.push_back(std::move(step));
    }
    const std::vector<Gaussian> errors = smooth(steps);
    std::vector<SmoothedPose> poses;
    for (std::size_t k = 0; k < errors.size(); ++k) {
        const Vector deviation = errors[k].covariance().diagonal().cwiseSqrt();
        poses.push_back(
            {.time = window_[k].forecast.time,
             .position = forecasts[k].position + errors[k].mean.head<3>(),
             .attitude = (exponential_map(errors[k].mean.segment<3>(6)) * forecasts[k].orientation)
                             .normalized(),
             .position_deviation = deviation.head<3>(),
             .attitude_deviation = deviation.segment<3>(6)});
    }
    return poses;
}

void SensorFilter::save_window(Archive& archive, const std::string& path) const {
    std::vector<double> numbers;
    for (const Snapshot& s : window_)
        visit_numbers(s, [&](double number) { numbers.push_back(number); });
    archive.put(path, std::span<const double>(numbers));
}

void SensorFilter::load_window(const Archive& archive, const std::string& path) {
    const auto numbers = archive.get<double>(path);
    window_.clear();
    for (auto next = numbers.begin(); next != numbers.end();) {
        window_.push_back({.forecast = {},
                           .measured = {},
                           .estimate = {},
                           .given = {},
                           .root = filter_.error().root});
        visit_numbers(window_.back(), [&](double& number) { number = *next++; });
    }
}

} // namespace bris
