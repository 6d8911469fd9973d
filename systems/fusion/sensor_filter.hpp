#pragma once

#include "engine/archive.hpp"
#include "engine/signal/inertial_filter.hpp"
#include "engine/signal/printed_filter.hpp"

#include <string>
#include <vector>

namespace bris {

/// Which mathematics turns a forecast and a measurement into an estimate.
enum class FilterKind : std::uint32_t {
    printed,     ///< as the report prints it, errors and all
    corrected,   ///< the same with them mended: displacement and velocity, attitude, spin
    error_state  ///< InertialFilter
};
inline const std::vector<std::string> filter_names{"printed", "corrected", "error_state"};

struct FilterSettings {
    FilterKind kind = FilterKind::corrected;
    // deviations at the first sample: of placement, of levelling, and of what came since
    double position = 3e-3, velocity = 1e-3; ///< m, m/s
    double attitude = 0.03, spin = 1e-2;     ///< rad, rad/s
    // what the model may miss: white noise of acceleration, where inertia matters; random walks, where it does not
    double acceleration_density = 1e-4;         ///< (m/s2)2/Hz
    double angular_acceleration_density = 1e-2; ///< (rad/s2)2/Hz
    double drift = 0;                           ///< m2 in a unit of time, or of what stands for it
    double turning = 0;                         ///< rad2, likewise
    double gate = 0.99;                         ///< probability with which a right measurement is let in; 1: all are
};

/// What the simulation says of a body, at the time of a measurement: s, or strain in a test that knows no time.
struct BodyForecast {
    double time = 0;
    RigidState state;
};

/// What was measured of it. NaN: not measured. Deviations hold for each axis.
struct Measured {
    Vec3 position, velocity, spin;
    Vec3 up; ///< unit vector upwards, in the body's axes: tilt without yaw
    Quat attitude;
    double position_deviation = 1e-4, velocity_deviation = 1e-3, spin_deviation = 1e-2, attitude_deviation = 0.01;
    Measured();
};

/// What a body's motion is to be corrected by.
struct Analysis {
    Vec3 shift = Vec3::Zero(), velocity = Vec3::Zero(), turn = Vec3::Zero(), spin = Vec3::Zero(); ///< m, m/s, rad, rad/s
    unsigned accepted = 0, refused = 0; ///< vectors measured
    double largest_distance = 0;        ///< squared, of an innovation: chi square of three degrees
};

/// The filter of one sensor: a forecast and a measurement in, a correction out.
class SensorFilter {
public:
    SensorFilter() = default;
    explicit SensorFilter(const FilterSettings& settings);

    Analysis analyse(const BodyForecast& forecast, const Measured& measured);

    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);

private:
    Analysis analyse_as_printed(const BodyForecast& forecast, const Measured& measured, double dt);

    FilterSettings settings_;
    InertialFilter filter_; // `corrected` uses its first four parts only
    PrintedFilter printed_;
    double last_time_ = 0;
    bool begun_ = false;
};

} // namespace bris
