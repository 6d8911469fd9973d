#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/sensors/sensor_info_options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

namespace bris {

namespace {

/// Writes a line of a metadata file for each option.
struct InfoLines {
    std::string text;
    void operator()(const std::string& name, const auto& value, const std::string& unit,
                    const std::string& help, const auto&...) {
        text +=
            fmt::format("{} = {}  # {}{}{}\n", name, value, unit, unit.empty() ? "" : ": ", help);
    }
};

} // namespace

void SensorInfo::set_pose(const Vec3& position, const Quat& attitude) {
    std::tie(x, y, z) = std::tuple(position.x(), position.y(), position.z());
    std::tie(qw, qx, qy, qz) = std::tuple(attitude.w(), attitude.x(), attitude.y(), attitude.z());
}

Vec3 SensorInfo::position() const { return {x, y, z}; }

Quat SensorInfo::attitude() const { return Quat(qw, qx, qy, qz).normalized(); }

void SensorInfo::set_placed(const Vec3& relative, const Quat& attitude) {
    std::tie(placed_x, placed_y, placed_z) = std::tuple(relative.x(), relative.y(), relative.z());
    std::tie(placed_qw, placed_qx, placed_qy, placed_qz) =
        std::tuple(attitude.w(), attitude.x(), attitude.y(), attitude.z());
}

Vec3 SensorInfo::placed_position() const { return {placed_x, placed_y, placed_z}; }

Quat SensorInfo::placed_attitude() const { return {placed_qw, placed_qx, placed_qy, placed_qz}; }

bool SensorInfo::is_placed() const { return placed_attitude().norm() > 0; }

Quat SensorInfo::mounting() const {
    return Quat(mounting_w, mounting_x, mounting_y, mounting_z).normalized();
}

double SensorInfo::temperature_of(double recorded) const {
    return temperature_unit == "C"   ? recorded + zero_celsius
           : temperature_unit == "F" ? (recorded - 32) / 1.8 + zero_celsius
                                     : recorded;
}

double SensorInfo::recorded_temperature(double kelvin) const {
    return temperature_unit == "C"   ? kelvin - zero_celsius
           : temperature_unit == "F" ? 1.8 * (kelvin - zero_celsius) + 32
                                     : kelvin;
}

void check_sensor_info(const SensorInfo& info, const std::string& where) {
    for (const auto& [q, what] :
         {std::pair{Quat(info.qw, info.qx, info.qy, info.qz), "qw qx qy qz"},
          std::pair{Quat(info.mounting_w, info.mounting_x, info.mounting_y, info.mounting_z),
                    "mounting_w x y z"}})
        require(std::abs(q.norm() - 1) < 1e-3,
                fmt::format("{}: {}: expected a unit quaternion, found one of norm {:.6g}", where,
                            what, q.norm()));
    const double norm = info.placed_attitude().norm();
    require(!info.is_placed() || std::abs(norm - 1) < 1e-3,
            fmt::format("{}: placed_qw qx qy qz: expected a unit quaternion, found one of norm "
                        "{:.6g}",
                        where, norm));
    require(info.is_placed() || info.placed_position() == Vec3::Zero(),
            fmt::format("{}: expected placed_qw qx qy qz with placed_x_over_radius, found none",
                        where));
}

SensorInfo read_sensor_info(const std::filesystem::path& path) {
    SensorInfo info;
    std::filesystem::path config;
    Options options;
    info.declare_options(options);
    options("config", config, "", "The metadata file.");
    (void)options.parse({"--config", path.string()});
    check_sensor_info(info, path.string());
    return info;
}

void write_sensor_info(const std::filesystem::path& path, SensorInfo info) {
    InfoLines lines;
    info.declare_options(lines);
    write_whole(path, lines.text);
}

} // namespace bris
