#include "scenarios/recordings/recording.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/recordings/device_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace bris {

namespace {

/// Writes a line of a metadata file for each option.
struct InfoLines {
    std::string text;
    template <class T, class... Rest>
    void operator()(const std::string& name, const T& value, const std::string& unit,
                    const std::string& help, const Rest&...) {
        text +=
            fmt::format("{} = {}  # {}{}{}\n", name, value, unit, unit.empty() ? "" : ": ", help);
    }
    void operator()(const std::string& name, const std::string& value, const std::string& unit,
                    const std::string& help, std::initializer_list<const char*>) {
        operator()<std::string>(name, value, unit, help);
    }
};

} // namespace

void SensorInfo::set_pose(const Vec3& position, const Quat& attitude) {
    std::tie(x, y, z) = std::tuple(position.x(), position.y(), position.z());
    std::tie(qw, qx, qy, qz) = std::tuple(attitude.w(), attitude.x(), attitude.y(), attitude.z());
}

void SensorInfo::set_placed(const Vec3& relative, const Quat& attitude) {
    std::tie(placed_x, placed_y, placed_z) = std::tuple(relative.x(), relative.y(), relative.z());
    std::tie(placed_qw, placed_qx, placed_qy, placed_qz) =
        std::tuple(attitude.w(), attitude.x(), attitude.y(), attitude.z());
}

double SensorInfo::tesla() const {
    return field_unit == "uT"   ? 1e-6
           : field_unit == "nT" ? 1e-9
           : field_unit == "mT" ? 1e-3
           : field_unit == "G"  ? 1e-4
           : field_unit == "mG" ? 1e-7
                                : 1;
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
    info.describe(options);
    options("config", config, "", "The metadata file.");
    (void)options.parse({"--config", path.string()});
    check_sensor_info(info, path.string());
    return info;
}

void write_sensor_info(const std::filesystem::path& path, SensorInfo info) {
    InfoLines lines;
    info.describe(lines);
    write_whole(path, lines.text);
}

void reject_flagged(Recording& r) {
    const auto without_any = [](const auto& numbers) {
        return std::ranges::none_of(numbers, [](const auto& n) {
            if constexpr (requires { n.allFinite(); })
                return n.allFinite();
            else
                return std::isfinite(n);
        });
    };
    const auto empty_if_none = [&](const char* channel, auto& numbers) {
        if (!without_any(numbers)) return;
        numbers.clear();
        r.first_without.erase(channel);
    };
    std::vector<char> is_flagged;
    for (const std::uint64_t flags : r.flags) is_flagged.push_back(r.info.leaves_out(flags));
    const auto keep = [&](auto& values) {
        std::size_t kept = 0;
        for (std::size_t k = 0; k < values.size(); ++k)
            if (!is_flagged[k]) values[kept++] = values[k];
        values.resize(kept);
    };
    if (std::ranges::count(is_flagged, 1) > 0) {
        for (std::size_t k = 0; k < r.size(); ++k)
            if (is_flagged[k]) r.flagged.push_back(r.time[k]);
        for (auto* values : {&r.time, &r.strain, &r.phase}) keep(*values);
        for (const DeviceChannel& channel : device_channels()) keep(r.*channel.values);
        for (auto* values : {&r.force, &r.rate, &r.field, &r.displacement}) keep(*values);
        for (auto* values : {&r.sequence, &r.flags}) keep(*values);
        keep(r.attitude);
    }
    empty_if_none("strain", r.strain);
    empty_if_none("phase", r.phase);
    empty_if_none("mx my mz", r.field);
    for (const DeviceChannel& channel : device_channels())
        empty_if_none(channel.column, r.*channel.values);
}

} // namespace bris
