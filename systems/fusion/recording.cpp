#include "systems/fusion/recording.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace bris {

namespace {

constexpr double standard_gravity = 9.80665;

/// Columns of a vector: all of them, or none.
template <std::size_t N> struct Channel {
    std::array<std::vector<double>, N> columns;
    bool present = false;

    Channel(const CsvTable& table, const std::array<const char*, N>& names) {
        const auto there = std::ranges::count_if(names, [&](const char* name) { return table.has(name); });
        present = there > 0;
        if (!present) return;
        for (std::size_t k = 0; k < N; ++k) columns[k] = table.column(names[k]); // names the one that is missing
    }
    Eigen::Matrix<double, N, 1> operator()(std::size_t row) const {
        Eigen::Matrix<double, N, 1> v;
        for (std::size_t k = 0; k < N; ++k) v[static_cast<Eigen::Index>(k)] = columns[k][row];
        return v;
    }
};

std::string at_line(const CsvTable& table, std::size_t row) { return fmt::format("{}:{}", table.path.string(), table.lines[row]); }

/// A whole number of a column, from 0 on.
std::uint64_t count_of(const CsvTable& table, std::size_t row, const char* name, double value) {
    require(value >= 0 && value < 9e15 && value == std::floor(value),
            fmt::format("{}: {}: expected a whole number from 0 on, found {}", at_line(table, row), name, value));
    return static_cast<std::uint64_t>(value);
}

} // namespace

SensorInfo read_sensor_info(const std::filesystem::path& path) {
    SensorInfo info;
    std::filesystem::path config;
    Options options;
    info.describe(options);
    options("config", config, "", "the metadata file");
    (void)options.parse({"--config", path.string()});
    for (const auto& [q, what] : {std::pair{Quat(info.qw, info.qx, info.qy, info.qz), "qw qx qy qz"},
                                  std::pair{Quat(info.mounting_w, info.mounting_x, info.mounting_y, info.mounting_z), "mounting_w x y z"}})
        require(std::abs(q.norm() - 1) < 1e-3, fmt::format("{}: {}: expected a unit quaternion, found one of norm {:.6g}", path.string(), what, q.norm()));
    return info;
}

std::vector<Recording> read_recordings(const std::filesystem::path& csv, const std::vector<SensorInfo>& sensors) {
    std::vector<Recording> recordings;
    std::map<std::uint64_t, std::size_t> place;
    for (const SensorInfo& info : sensors) {
        require(place.emplace(info.id, recordings.size()).second, fmt::format("sensor {}: expected one metadata file, found two", info.id));
        recordings.emplace_back().info = info;
    }
    const CsvTable table = read_csv(csv);
    const auto time = table.column("t"), id = table.column("id");
    const Channel<3> force(table, {"ax", "ay", "az"}), rate(table, {"gx", "gy", "gz"}), displacement(table, {"ux", "uy", "uz"});
    const Channel<4> attitude(table, {"qw", "qx", "qy", "qz"});
    const Channel<1> sequence(table, {"seq"}), strain(table, {"strain"});
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto found = place.find(count_of(table, row, "id", id[row]));
        require(found != place.end(), fmt::format("{}: id: expected that of a metadata file, found {}", at_line(table, row), id[row]));
        Recording& r = recordings[found->second];
        const Quat mounting = r.info.mounting();
        r.time.push_back(time[row]);
        if (sequence.present) r.sequence.push_back(count_of(table, row, "seq", sequence(row)[0]));
        if (strain.present) r.strain.push_back(strain(row)[0]);
        if (force.present) r.force.push_back((r.info.force_unit == "g" ? standard_gravity : 1) * (mounting * Vec3(force(row))));
        if (rate.present) r.rate.push_back((r.info.rate_unit == "deg/s" ? pi / 180 : 1) * (mounting * Vec3(rate(row))));
        if (displacement.present) r.displacement.push_back(displacement(row));
        if (attitude.present) {
            const auto q = attitude(row);
            r.attitude.emplace_back(q[0], q[1], q[2], q[3]);
        }
    }
    return recordings;
}

} // namespace bris
