#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace bris {

inline constexpr double standard_gravity = 9.80665; ///< m/s2, the unit "g" of accelerometers
inline constexpr double zero_celsius = 273.15;      ///< K

/// Metadata of a SmartRock: a file of `name = value` lines for each sensor.
struct SensorInfo {
    unsigned id = 0;
    double x = 0, y = 0, z = 0;            ///< m, centre of the rock at the start, world frame
    double qw = 1, qx = 0, qy = 0, qz = 0; ///< attitude at the start, body to world
    /// Pose in which the rock was placed when the specimen was built: relative to the radius (x, y)
    /// and the height (z) of the mould. A quaternion of 0: not known.
    double placed_x = 0, placed_y = 0, placed_z = 0;
    double placed_qw = 0, placed_qx = 0, placed_qy = 0, placed_qz = 0;
    double position_deviation = 3e-3; ///< m, standard deviation of the initial position
    double attitude_deviation = 2;    ///< degrees, standard deviation of the initial attitude
    /// Lever arm from the centre to the sensor, m, in body axes.
    double arm_x = 0, arm_y = 0, arm_z = 0;
    /// Rotation from the axes of the sensor to those of the body.
    double mounting_w = 1, mounting_x = 0, mounting_y = 0, mounting_z = 0;
    std::string force_unit = "m/s2", rate_unit = "rad/s"; ///< of the recording
    double sampling_rate = 200;                           ///< Hz
    double force_range = 160, rate_range = 35;            ///< m/s2 and rad/s
    double force_noise = 1e-3, rate_noise = 1e-4;         ///< m/s2/sqrt(Hz) and rad/s/sqrt(Hz)
    /// Standard deviation of the biases after calibration, m/s2 and rad/s.
    double force_bias = 1e-2, rate_bias = 2e-3;
    double displacement_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of these channels
    /// Lead of the clock over that of the test machine and its standard deviation, s.
    double clock_offset = 0, clock_offset_deviation = 1;
    std::string field_unit = "uT", temperature_unit = "C", battery_unit = "V"; ///< of the recording
    /// Noise of a sample and standard deviation of the bias after calibration, uT.
    double field_noise = 0.5, field_bias = 2;
    double battery_low = 0; ///< V or %, limit of a low battery; 0: 3.3 V (one lithium cell) or 15 %
    unsigned flags_ignored = 0; ///< bits of `flags` that do not reject a sample

    void declare_options(auto& option); ///< in sensor_info_options.hpp
    /// Whether a sample with these flags is left out.
    bool leaves_out(std::uint64_t flags) const {
        return (flags & ~std::uint64_t{flags_ignored}) != 0;
    }
    void set_pose(const Vec3& position, const Quat& attitude);
    Vec3 position() const;
    Quat attitude() const;
    void set_placed(const Vec3& relative, const Quat& attitude);
    Vec3 placed_position() const;
    Quat placed_attitude() const;
    bool is_placed() const;
    Quat mounting() const;
    double temperature_of(double recorded) const; ///< K, of one in temperature_unit
    double recorded_temperature(double kelvin) const;
};

/// Reads a metadata file. Throws InputError with file:line, what was expected and what was found.
SensorInfo read_sensor_info(const std::filesystem::path& path);

/// Checks what the ranges of the options do not: that quaternions have norm 1. Throws InputError.
void check_sensor_info(const SensorInfo& info, const std::string& where);

/// Writes a metadata file. Throws OutputError.
void write_sensor_info(const std::filesystem::path& path, SensorInfo info);

} // namespace bris
