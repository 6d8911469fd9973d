#pragma once

#include "engine/math.hpp"
#include "engine/options.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bris {

struct CsvForm;
struct KnownColumn;

inline constexpr double standard_gravity = 9.80665; ///< m/s2, in which accelerometers are graded
inline constexpr double zero_celsius = 273.15;      ///< K

/// What is known of a SmartRock beforehand: one file of `name = value` lines for each.
struct SensorInfo {
    unsigned id = 0;
    double x = 0, y = 0, z = 0;            ///< m, centre at the start, world frame
    double qw = 1, qx = 0, qy = 0, qz = 0; ///< attitude at the start, body to world
    double position_deviation = 3e-3;      ///< m, of the placement
    double attitude_deviation = 2;         ///< degrees, of the levelling
    double arm_x = 0, arm_y = 0,
           arm_z = 0; ///< m, from the centre to the sensor, in the body's axes
    double mounting_w = 1, mounting_x = 0, mounting_y = 0,
           mounting_z = 0;                                ///< sensor's axes to the body's
    std::string force_unit = "m/s2", rate_unit = "rad/s"; ///< of the recording
    double sampling_rate = 200;                           ///< Hz
    double force_range = 160, rate_range = 35;            ///< m/s2 and rad/s
    double force_noise = 1e-3, rate_noise = 1e-4;         ///< m/s2/sqrt(Hz) and rad/s/sqrt(Hz)
    double force_bias = 1e-2, rate_bias = 2e-3; ///< m/s2 and rad/s, deviation after calibration
    double displacement_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of these channels
    double clock_offset = 0,
           clock_offset_deviation = 1; ///< s, by which its clock is ahead of the test machine's
    std::string field_unit = "uT", temperature_unit = "C", battery_unit = "V"; ///< of the recording
    double field_noise = 0.5, field_bias = 2; ///< uT, of a sample, and deviation after calibration
    double battery_low = 0; ///< V or %, below which it is low; 0: 3.3 V (one lithium cell) or 15 %
    unsigned flags_ignored = 0; ///< bits of flags that say nothing against a sample

    void describe(auto& option);
    bool leaves_out(std::uint64_t flags) const {
        return (flags & ~std::uint64_t{flags_ignored}) != 0;
    } ///< a sample with these
    void set_pose(const Vec3& position, const Quat& attitude);
    Vec3 position() const { return {x, y, z}; }
    Quat attitude() const { return Quat(qw, qx, qy, qz).normalized(); }
    Quat mounting() const {
        return Quat(mounting_w, mounting_x, mounting_y, mounting_z).normalized();
    }
    // from what a file has to SI units and the body's axes, and back
    Vec3 force_of(const Vec3& recorded) const {
        return (force_unit == "g" ? standard_gravity : 1) * (mounting() * recorded);
    }
    Vec3 rate_of(const Vec3& recorded) const {
        return (rate_unit == "deg/s" ? pi / 180 : 1) * (mounting() * recorded);
    }
    Vec3 field_of(const Vec3& recorded) const { return tesla() * (mounting() * recorded); }
    double temperature_of(double recorded) const;
    double tesla() const; ///< in one of field_unit
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

/// Whether a number counts something, exactly: whole, from 0 on.
inline bool is_count(double n) { return n >= 0 && n < 9e15 && n == std::floor(n); }

/// Reads a metadata file. Throws InputError with file:line, what was expected and what was found.
SensorInfo read_sensor_info(const std::filesystem::path& path);

/// What no range says: that quaternions are of norm 1. Throws InputError.
void check_sensor_info(const SensorInfo& info, const std::string& where);

/// Writes one. Throws OutputError.
void write_sensor_info(const std::filesystem::path& path, SensorInfo info);

/// What one SmartRock recorded, in SI units and in its body's axes, in the order of arrival. A
/// vector of a sample that lacks it is NaN, which the intake refuses; field, temperature, battery,
/// strain and phase may be sampled less often (NaN). A channel that the file lacks is empty.
struct Recording {
    SensorInfo info;
    std::vector<double> time;            ///< s, by the sensor's clock
    std::vector<double> strain;          ///< axial, of the test
    std::vector<double> phase;           ///< cycles of load since the test began
    std::vector<std::uint64_t> sequence; ///< counts samples
    std::vector<Vec3> force, rate;       ///< m/s2 and rad/s
    std::vector<Vec3> field;             ///< T, of the magnetometer
    std::vector<Vec3> displacement;      ///< m, world frame, from other means than inertia
    std::vector<Quat> attitude;          ///< body to world
    std::vector<double> temperature;     ///< K, of the sensor
    std::vector<double> battery;         ///< in its unit
    std::vector<std::uint64_t> flags;    ///< see reject_flagged
    std::vector<double> flagged;         ///< s, times of samples that were left out
    std::map<std::string, std::string>
        first_without; ///< by channel: where the first of the samples not left out stands that has
                       ///< no number in it
    std::size_t size() const { return time.size(); }
    /// Remembers a place if one of the numbers is none.
    void look_for_numbers(const char* channel, const auto& numbers, const std::string& where) {
        if (!numbers.allFinite()) first_without.emplace(channel, where);
    }
};

/// Leaves out what the sensor itself says not to use: samples with flags other than 0, but for
/// flags_ignored. Channels of numbers that are allowed to be none, and are so in all samples, are
/// emptied: this sensor does not have them.
void reject_flagged(Recording& recording);

/// The columns that recordings may have, with the units in which a column map may give them.
const std::vector<KnownColumn>& recording_columns();

/// Reads recordings of several SmartRocks from one long CSV file: columns t and id, and of ax ay
/// az, gx gy gz, mx my mz, ux uy uz, qw qx qy qz, temp, batt, seq, flags, strain and phase those
/// that there are; others are let be. Rows of an id without metadata, and a vector of which a
/// column is missing, are refused. A unit that the form gives stands in place of that of the
/// metadata. Throws InputError with file:line.
std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors);
std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors, const CsvForm& form);

/// Writes the channels that all of them have, sample by sample, without those left out. In the
/// units of the metadata; mountings are turned back. Throws OutputError.
void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings,
                      const std::vector<std::string>& comments);

/// The same from and to one HDF5 file: /sensors/ID/time, and of accel (n x 3), gyro, mag,
/// displacement, quat (n x 4: w x y z), temperature, battery, sequence, flags, strain and phase
/// those that there are; the metadata are attributes of /sensors/ID, and where there are any, units
/// must be those of the metadata given. Throws InputError where shapes, ids or units do not fit,
/// OutputError where the file cannot be read.
std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path,
                                            const std::vector<SensorInfo>& sensors);
std::vector<SensorInfo> read_sensor_infos_hdf5(const std::filesystem::path& path);
void write_recordings_hdf5(const std::filesystem::path& path,
                           const std::vector<Recording>& recordings);

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
    option("field_unit", field_unit, "", "of mx my mz", {"uT", "nT", "mT", "T", "G", "mG"});
    option("temperature_unit", temperature_unit, "", "of temp", {"C", "K", "F"});
    option("battery_unit", battery_unit, "", "of batt", {"V", "%"});
    option("field_noise", field_noise, "uT", "of a sample of mx my mz", above(0));
    option("field_bias", field_bias, "uT", "deviation after calibration", at_least(0));
    option("battery_low", battery_low, "V or %", "below which it is low; 0: 3.3 V or 15 %",
           at_least(0));
    option("flags_ignored", flags_ignored, "", "bits of flags that say nothing against a sample");
}

} // namespace bris
