#include "engine/signal/roll_pitch_yaw.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double pole = 1e-7; // cosine of the pitch from which roll and yaw are not separate

double nearest_turn(double angle, double to) { return to + std::remainder(angle - to, 2 * pi); }

RollPitchYaw nearest_turns(const RollPitchYaw& a, const RollPitchYaw& to) {
    return {nearest_turn(a.roll, to.roll), nearest_turn(a.pitch, to.pitch),
            nearest_turn(a.yaw, to.yaw)};
}

double squared_distance(const RollPitchYaw& a, const RollPitchYaw& b) {
    return std::pow(a.roll - b.roll, 2) + std::pow(a.pitch - b.pitch, 2) +
           std::pow(a.yaw - b.yaw, 2);
}

} // namespace

Quat quaternion_of(const RollPitchYaw& a) {
    const Quat about_z(std::cos(a.yaw / 2), 0, 0, std::sin(a.yaw / 2)),
        about_y(std::cos(a.pitch / 2), 0, std::sin(a.pitch / 2), 0),
        about_x(std::cos(a.roll / 2), std::sin(a.roll / 2), 0, 0);
    return about_z * about_y * about_x;
}

RollPitchYaw roll_pitch_yaw_of(const Quat& attitude) {
    const Mat3 m = attitude.normalized().toRotationMatrix();
    const double cosine = std::hypot(m(0, 0), m(1, 0)), pitch = std::atan2(-m(2, 0), cosine);
    if (cosine < pole) return {0, pitch, std::atan2(-m(0, 1), m(1, 1))};
    return {std::atan2(m(2, 1), m(2, 2)), pitch, std::atan2(m(1, 0), m(0, 0))};
}

std::vector<RollPitchYaw> unwrapped_roll_pitch_yaw(const std::vector<Quat>& attitudes) {
    std::vector<RollPitchYaw> series;
    for (const Quat& q : attitudes) {
        RollPitchYaw now = roll_pitch_yaw_of(q);
        if (series.empty()) {
            series.push_back(now);
            continue;
        }
        const RollPitchYaw& before = series.back();
        if (std::cos(now.pitch) < pole) { // yaw -+ roll is kept, the roll is that before
            const double sign = now.pitch > 0 ? 1 : -1;
            now.yaw += sign * before.roll;
            now.roll = before.roll;
        }
        const RollPitchYaw one = nearest_turns(now, before),
                           other =
                               nearest_turns({now.roll + pi, pi - now.pitch, now.yaw + pi}, before);
        series.push_back(squared_distance(one, before) <= squared_distance(other, before) ? one
                                                                                          : other);
    }
    return series;
}

std::vector<double> unwrapped(std::vector<double> angles) {
    for (std::size_t k = 1; k < angles.size(); ++k)
        angles[k] = nearest_turn(angles[k], angles[k - 1]);
    return angles;
}

} // namespace bris
