#pragma once

#include "engine/math.hpp"
#include "engine/options.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

inline constexpr double standard_gravity = 9.80665; ///< m/s2, in which accelerometers are graded

/// What is known of a SmartRock beforehand: one file of `name = value` lines for each.
struct SensorInfo {
    unsigned id = 0;
    double x = 0, y = 0, z = 0;                      ///< m, centre at the start, world frame
    double qw = 1, qx = 0, qy = 0, qz = 0;           ///< attitude at the start, body to world
    double position_deviation = 3e-3;                ///< m, of the placement
    double attitude_deviation = 2;                   ///< degrees, of the levelling
    double arm_x = 0, arm_y = 0, arm_z = 0;          ///< m, from the centre to the sensor, in the body's axes
    double mounting_w = 1, mounting_x = 0, mounting_y = 0, mounting_z = 0; ///< sensor's axes to the body's
    std::string force_unit = "m/s2", rate_unit = "rad/s"; ///< of the recording
    double sampling_rate = 200;                      ///< Hz
    double force_range = 160, rate_range = 35;       ///< m/s2 and rad/s
    double force_noise = 1e-3, rate_noise = 1e-4;    ///< m/s2/sqrt(Hz) and rad/s/sqrt(Hz)
    double force_bias = 1e-2, rate_bias = 2e-3;      ///< m/s2 and rad/s, deviation after calibration
    double displacement_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of these channels
    double clock_offset = 0, clock_offset_deviation = 1;     ///< s, by which its clock is ahead of the test machine's

    void describe(auto& option);
    void set_pose(const Vec3& position, const Quat& attitude);
    Vec3 position() const { return {x, y, z}; }
    Quat attitude() const { return Quat(qw, qx, qy, qz).normalized(); }
    Quat mounting() const { return Quat(mounting_w, mounting_x, mounting_y, mounting_z).normalized(); }
    // from what a file has to SI units and the body's axes, and back
    Vec3 force_of(const Vec3& recorded) const { return (force_unit == "g" ? standard_gravity : 1) * (mounting() * recorded); }
    Vec3 rate_of(const Vec3& recorded) const { return (rate_unit == "deg/s" ? pi / 180 : 1) * (mounting() * recorded); }
    Vec3 recorded_force(const Vec3& force) const { return (force_unit == "g" ? 1 / standard_gravity : 1) * (mounting().conjugate() * force); }
    Vec3 recorded_rate(const Vec3& rate) const { return (rate_unit == "deg/s" ? 180 / pi : 1) * (mounting().conjugate() * rate); }
};

/// Reads a metadata file. Throws InputError with file:line, what was expected and what was found.
SensorInfo read_sensor_info(const std::filesystem::path& path);

/// Writes one. Throws OutputError.
void write_sensor_info(const std::filesystem::path& path, SensorInfo info);

/// What one SmartRock recorded, in SI units and in its body's axes, in the order of arrival. A vector of a sample that
/// lacks it is NaN, which the intake refuses; a channel that the file lacks is empty.
struct Recording {
    SensorInfo info;
    std::vector<double> time;            ///< s, by the sensor's clock
    std::vector<double> strain;          ///< axial, of the test
    std::vector<std::uint64_t> sequence; ///< counts samples
    std::vector<Vec3> force, rate;       ///< m/s2 and rad/s
    std::vector<Vec3> displacement;      ///< m, world frame, from other means than inertia
    std::vector<Quat> attitude;          ///< body to world
    std::size_t size() const { return time.size(); }
};

/// Reads recordings of several SmartRocks from one long CSV file: columns t and id, and of ax ay az, gx gy gz, ux uy uz,
/// qw qx qy qz, seq and strain those that there are; others are let be. Rows of an id without metadata, and a vector of
/// which a column is missing, are refused. Throws InputError with file:line.
std::vector<Recording> read_recordings(const std::filesystem::path& csv, const std::vector<SensorInfo>& sensors);

/// Writes the channels that all of them have, sample by sample. SI units; mountings are turned back. Throws OutputError.
void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings, const std::vector<std::string>& comments);

/// The same from and to one HDF5 file: /sensors/ID/time, and of accel (n x 3), gyro, displacement, quat (n x 4: w x y z),
/// sequence and strain those that there are. Throws InputError where shapes or ids do not fit, OutputError where the file
/// cannot be read.
std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path, const std::vector<SensorInfo>& sensors);
void write_recordings_hdf5(const std::filesystem::path& path, const std::vector<Recording>& recordings);

void SensorInfo::describe(auto& option) {
    option("id", id, "", "as in the recordings");
    option("x", x, "m", "centre at the start");
    option("y", y, "m", "likewise");
    option("z", z, "m", "likewise, upwards");
    option("qw", qw, "", "attitude at the start, body to world", within(-1, 1));
    option("qx", qx, "", "likewise", within(-1, 1));
    option("qy", qy, "", "likewise", within(-1, 1));
    option("qz", qz, "", "likewise", within(-1, 1));
    option("position_deviation", position_deviation, "m", "of the placement", above(0));
    option("attitude_deviation", attitude_deviation, "degrees", "of the levelling", above(0));
    option("arm_x", arm_x, "m", "from the centre to the sensor, in the body's axes");
    option("arm_y", arm_y, "m", "likewise");
    option("arm_z", arm_z, "m", "likewise");
    option("mounting_w", mounting_w, "", "attitude of the sensor in the body", within(-1, 1));
    option("mounting_x", mounting_x, "", "likewise", within(-1, 1));
    option("mounting_y", mounting_y, "", "likewise", within(-1, 1));
    option("mounting_z", mounting_z, "", "likewise", within(-1, 1));
    option("force_unit", force_unit, "", "of ax ay az", {"m/s2", "g"});
    option("rate_unit", rate_unit, "", "of gx gy gz", {"rad/s", "deg/s"});
    option("sampling_rate", sampling_rate, "Hz", "nominal", above(0));
    option("force_range", force_range, "m/s2", "largest that is measured", above(0));
    option("rate_range", rate_range, "rad/s", "likewise", above(0));
    option("force_noise", force_noise, "m/s2/sqrt(Hz)", "density", at_least(0));
    option("rate_noise", rate_noise, "rad/s/sqrt(Hz)", "density", at_least(0));
    option("force_bias", force_bias, "m/s2", "deviation after calibration", at_least(0));
    option("rate_bias", rate_bias, "rad/s", "deviation after calibration", at_least(0));
    option("displacement_noise", displacement_noise, "m", "of ux uy uz", above(0));
    option("attitude_noise", attitude_noise, "rad", "of qw qx qy qz", above(0));
    option("clock_offset", clock_offset, "s", "by which its clock is ahead of the test machine's");
    option("clock_offset_deviation", clock_offset_deviation, "s", "of that", at_least(0));
}

} // namespace bris
