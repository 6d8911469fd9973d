#include "scenarios/sensors/sensor_trajectory.hpp"

#include "engine/errors.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/sensors/heading.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace bris {

namespace {

const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

Observability seen_by(std::string direction, std::string source, double deviation, double model) {
    const double p = model * model, r = deviation * deviation;
    return {std::move(direction), std::move(source), deviation, p > 0 ? p / (p + r) : 0};
}

} // namespace

SensorTrajectory trajectory_of(const Recording& recording, double interval) {
    require(recording.strain.size() == recording.size(),
            fmt::format("sensor {}: expected a column strain, found none", recording.info.id));
    SensorTrajectory trajectory;
    Quat first_attitude = recording.info.attitude();
    Vec3 first_up = unknown, first_displacement = Vec3::Zero();
    double last = 0;
    for (std::size_t k = 0; k < recording.size(); ++k) {
        const double strain = recording.strain[k];
        if (!std::isfinite(strain)) continue;
        const bool has_force = !recording.force.empty() && recording.force[k].allFinite() &&
                               recording.force[k].norm() > 0.5 * standard_gravity;
        const Vec3 up = has_force ? Vec3(recording.force[k].normalized()) : unknown;
        const bool has_attitude =
            !recording.attitude.empty() && recording.attitude[k].coeffs().allFinite();
        const bool has_displacement =
            !recording.displacement.empty() && recording.displacement[k].allFinite();
        if (strain <= 0) { // reference before the test begins: the last sample counts
            if (has_force) first_up = up;
            if (has_attitude) first_attitude = recording.attitude[k];
            if (has_displacement) first_displacement = recording.displacement[k];
            continue;
        }
        if (strain - last < 0.999 * interval) continue;
        last = strain;
        trajectory.strain.push_back(strain);
        trajectory.displacement.push_back(
            has_displacement ? Vec3(recording.displacement[k] - first_displacement) : unknown);
        trajectory.rotation.push_back(
            has_attitude ? attitude_error(recording.attitude[k], first_attitude) : unknown);
        // a bias of the accelerometers that is the same at both times cancels
        trajectory.tilt.push_back(has_force && first_up.allFinite() ? Vec3(first_up - up)
                                                                    : unknown);
    }
    return trajectory;
}

std::vector<Observability> observability_of(const Recording& recording, double duration,
                                            double drift, double turn) {
    const SensorInfo& info = recording.info;
    const bool tracked = !recording.displacement.empty(), oriented = !recording.attitude.empty(),
               inertial = !recording.force.empty();
    const double integrated =
        std::hypot(0.5 * info.force_bias * duration * duration,
                   info.force_noise * std::sqrt(duration * duration * duration / 3));
    const double yaw = std::hypot(info.rate_bias * duration, info.rate_noise * std::sqrt(duration));
    const double tilt =
        std::hypot(info.force_bias, info.force_noise * std::sqrt(info.sampling_rate)) /
        standard_gravity;
    constexpr double nothing = std::numeric_limits<double>::infinity();
    std::vector<Observability> all;
    for (const char* axis : {"x", "y", "z"})
        all.push_back(tracked ? seen_by(axis, "displacement", info.displacement_noise, drift)
                              : seen_by(axis, inertial ? "twice integrated force" : "nothing",
                                        inertial ? integrated : nothing, drift));
    all.push_back(oriented ? seen_by("tilt", "attitude", info.attitude_noise, turn)
                           : seen_by("tilt", inertial ? "gravity" : "nothing",
                                     inertial ? tilt : nothing, turn));
    const Heading heading = recording.field.empty() || oriented
                                ? Heading{.unobservable_because = "not requested"}
                                : heading_of(recording);
    if (oriented)
        all.push_back(seen_by("yaw", "attitude", info.attitude_noise, turn));
    else if (heading.observable() && (recording.rate.empty() || heading.deviation < yaw))
        all.push_back(seen_by("yaw", "magnetometer (unused)", heading.deviation, turn));
    else
        all.push_back(seen_by("yaw", recording.rate.empty() ? "nothing" : "integrated rate",
                              recording.rate.empty() ? nothing : yaw, turn));
    return all;
}

} // namespace bris
