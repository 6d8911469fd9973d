#pragma once

#include "engine/math.hpp"
#include "engine/options.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bris {

struct CsvForm;
struct KnownColumn;

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

    void describe(auto& option);
    /// Whether a sample with these flags is left out.
    bool leaves_out(std::uint64_t flags) const {
        return (flags & ~std::uint64_t{flags_ignored}) != 0;
    }
    void set_pose(const Vec3& position, const Quat& attitude);
    Vec3 position() const { return {x, y, z}; }
    Quat attitude() const { return Quat(qw, qx, qy, qz).normalized(); }
    void set_placed(const Vec3& relative, const Quat& attitude);
    Vec3 placed_position() const { return {placed_x, placed_y, placed_z}; }
    Quat placed_attitude() const { return {placed_qw, placed_qx, placed_qy, placed_qz}; }
    bool is_placed() const { return placed_attitude().norm() > 0; }
    Quat mounting() const {
        return Quat(mounting_w, mounting_x, mounting_y, mounting_z).normalized();
    }
    // conversions between the units and axes of a file, and SI units and body axes
    Vec3 force_of(const Vec3& recorded) const {
        return (force_unit == "g" ? standard_gravity : 1) * (mounting() * recorded);
    }
    Vec3 rate_of(const Vec3& recorded) const {
        return (rate_unit == "deg/s" ? pi / 180 : 1) * (mounting() * recorded);
    }
    Vec3 field_of(const Vec3& recorded) const { return tesla() * (mounting() * recorded); }
    double temperature_of(double recorded) const;
    double tesla() const; ///< one field_unit in tesla
    Vec3 recorded_field(const Vec3& field) const {
        return mounting().conjugate() * field / tesla();
    }
    double recorded_temperature(double kelvin) const;
    Vec3 recorded_force(const Vec3& force) const {
        return (force_unit == "g" ? 1 / standard_gravity : 1) * (mounting().conjugate() * force);
    }
    Vec3 recorded_rate(const Vec3& rate) const {
        return (rate_unit == "deg/s" ? 180 / pi : 1) * (mounting().conjugate() * rate);
    }
};

/// Whether a number is a count: a non-negative whole number that a double represents exactly.
inline bool is_count(double n) { return n >= 0 && n < 9e15 && n == std::floor(n); }

/// Reads a metadata file. Throws InputError with file:line, what was expected and what was found.
SensorInfo read_sensor_info(const std::filesystem::path& path);

/// Checks what the ranges of the options do not: that quaternions have norm 1. Throws InputError.
void check_sensor_info(const SensorInfo& info, const std::string& where);

/// Writes a metadata file. Throws OutputError.
void write_sensor_info(const std::filesystem::path& path, SensorInfo info);

/// Recording of one SmartRock, in SI units and in body axes, in order of arrival. A sample without
/// time, force, rate, displacement or attitude has NaN there, which quality control refuses;
/// strain, phase, field, temperature and battery may be sampled less often (NaN). A channel that
/// the file does not have is empty.
struct Recording {
    SensorInfo info;
    std::vector<double> time;            ///< s, by the clock of the sensor
    std::vector<double> strain;          ///< axial, of the test
    std::vector<double> phase;           ///< load cycles since the test began
    std::vector<std::uint64_t> sequence; ///< sample counter
    std::vector<Vec3> force, rate;       ///< specific force, m/s2, and angular rate, rad/s
    std::vector<Vec3> field;             ///< T, of the magnetometer
    std::vector<Vec3> displacement;      ///< m, world frame, by other means than inertia
    std::vector<Quat> attitude;          ///< body to world
    std::vector<double> temperature;     ///< K, of the sensor
    std::vector<double> battery;         ///< V or %, info.battery_unit
    std::vector<std::uint64_t> flags;    ///< see reject_flagged
    std::vector<double> flagged;         ///< s, times of the samples that were left out
    /// By channel: location (file and line) of the first sample, not left out, without a finite
    /// number.
    std::map<std::string, std::string> first_without;
    std::vector<std::string> unused; ///< fields of the file that are no channel, by their names
    std::size_t size() const { return time.size(); }
    /// Stores the location as first_without if one of the numbers is not finite.
    void look_for_numbers(const char* channel, const auto& numbers, const std::string& where) {
        if (!numbers.allFinite()) first_without.emplace(channel, where);
    }
};

/// Removes samples that the sensor itself flags as unusable: flags other than 0, except for the
/// bits of flags_ignored. Also empties optional channels (strain, phase, field, temperature,
/// battery) without any finite number: this sensor does not have them.
void reject_flagged(Recording& recording);

/// The columns that recordings may have, with the units that a column map may give.
const std::vector<KnownColumn>& recording_columns();

/// Reads the recordings of several SmartRocks from one CSV file with a row for each sample. Columns
/// t and id; optional: ax ay az, gx gy gz, mx my mz, ux uy uz, qw qx qy qz, temp, batt, seq, flags,
/// strain and phase; others are ignored, whatever they hold. A unit given by `form` replaces that
/// of the metadata. Throws InputError with file:line, also for rows of an id without metadata and
/// for vectors with a missing column.
std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors);
std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors, const CsvForm& form);

/// Writes the channels that all recordings have, in order of time, without samples left out, in the
/// units of the metadata and in the axes of the sensors. Throws OutputError.
void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings,
                      const std::vector<std::string>& comments);

/// Reads and writes the same as one HDF5 file: /sensors/ID/time; optional: accel (n x 3), gyro,
/// mag, displacement, quat (n x 4: w x y z), temperature, battery, sequence, flags, strain and
/// phase; others are ignored. The metadata are attributes of /sensors/ID; units given there, or as
/// attribute units of a dataset, must be those of `sensors`.
/// Throws InputError for wrong shapes, ids or units, OutputError if the file cannot be read or
/// written.
std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path,
                                            const std::vector<SensorInfo>& sensors);
std::vector<SensorInfo> read_sensor_infos_hdf5(const std::filesystem::path& path);
void write_recordings_hdf5(const std::filesystem::path& path,
                           const std::vector<Recording>& recordings);

void SensorInfo::describe(auto& option) {
    const auto quaternion = [&](const std::string& name, std::array<double*, 4> wxyz,
                                const std::string& what) {
        for (std::size_t i = 0; i < wxyz.size(); ++i) {
            const std::string part(1, "wxyz"[i]);
            option(name + part, *wxyz[i], "", what + ": quaternion, " + part + ".", within(-1, 1));
        }
    };
    option("id", id, "", "Number of the sensor in the recordings.");
    const Range in_reach = within(-100, 100), in_rock = within(-1, 1); // m; not in mm
    option("x", x, "m", "Coordinate x of the centre of the rock at the start.", in_reach);
    option("y", y, "m", "Coordinate y of the centre of the rock at the start.", in_reach);
    option("z", z, "m", "Coordinate z (upwards) of the centre of the rock at the start.", in_reach);
    quaternion("q", {&qw, &qx, &qy, &qz}, "Attitude at the start, body to world");
    option("placed_x_over_radius", placed_x, "",
           "Coordinate x, over the radius of the specimen, where the rock was placed when the "
           "specimen was built. All names that begin with placed_ may be omitted: then the rock "
           "was placed as it is at the start.");
    option("placed_y_over_radius", placed_y, "", "Coordinate y, over the radius, likewise.");
    option("placed_z_over_height", placed_z, "",
           "Coordinate z, over the height of the specimen, likewise.");
    quaternion("placed_q", {&placed_qw, &placed_qx, &placed_qy, &placed_qz},
               "Attitude in which it was placed");
    option("position_deviation", position_deviation, "m",
           "Standard deviation of the position at the start.", above(0));
    option("attitude_deviation", attitude_deviation, "degrees",
           "Standard deviation of the attitude at the start.", above(0));
    option("arm_x", arm_x, "m", "Lever arm from the centre to the sensor, body axes: x.", in_rock);
    option("arm_y", arm_y, "m", "Lever arm from the centre to the sensor, body axes: y.", in_rock);
    option("arm_z", arm_z, "m", "Lever arm from the centre to the sensor, body axes: z.", in_rock);
    quaternion("mounting_", {&mounting_w, &mounting_x, &mounting_y, &mounting_z},
               "Rotation from sensor axes to body axes");
    option("force_unit", force_unit, "", "Unit of ax ay az.", {"m/s2", "g"});
    option("rate_unit", rate_unit, "", "Unit of gx gy gz.", {"rad/s", "deg/s"});
    option("sampling_rate", sampling_rate, "Hz", "Nominal sampling rate.", above(0, 1e6));
    option("force_range", force_range, "m/s2", "Largest specific force that the sensor measures.",
           above(0));
    option("rate_range", rate_range, "rad/s", "Largest angular rate that the sensor measures.",
           above(0));
    option("force_noise", force_noise, "m/s2/sqrt(Hz)", "Noise density of the accelerometer.",
           at_least(0));
    option("rate_noise", rate_noise, "rad/s/sqrt(Hz)", "Noise density of the gyroscope.",
           at_least(0));
    option("force_bias", force_bias, "m/s2",
           "Standard deviation of the accelerometer bias after calibration.", at_least(0));
    option("rate_bias", rate_bias, "rad/s",
           "Standard deviation of the gyroscope bias after calibration.", at_least(0));
    option("displacement_noise", displacement_noise, "m", "Standard deviation of ux uy uz.",
           above(0));
    option("attitude_noise", attitude_noise, "rad",
           "Standard deviation of the attitude qw qx qy qz.", above(0));
    option("clock_offset", clock_offset, "s",
           "Lead of the clock of the sensor over that of the test machine.");
    option("clock_offset_deviation", clock_offset_deviation, "s",
           "Standard deviation of clock_offset.", at_least(0));
    option("field_unit", field_unit, "", "Unit of mx my mz.", {"uT", "nT", "mT", "T", "G", "mG"});
    option("temperature_unit", temperature_unit, "", "Unit of temp.", {"C", "K", "F"});
    option("battery_unit", battery_unit, "", "Unit of batt.", {"V", "%"});
    option("field_noise", field_noise, "uT", "Standard deviation of a sample of mx my mz.",
           above(0));
    option("field_bias", field_bias, "uT",
           "Standard deviation of the magnetometer bias after calibration.", at_least(0));
    option("battery_low", battery_low, "V or %",
           "Level below which the battery is low; 0: 3.3 V or 15 %.", at_least(0));
    option("flags_ignored", flags_ignored, "", "Bits of flags that do not reject a sample.");
}

} // namespace bris
