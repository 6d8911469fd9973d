#include "systems/fusion/recording.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace bris {

namespace {

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

/// A line for each option of a metadata file.
struct InfoLines {
    std::string text;
    template <class T, class... Rest>
    void operator()(const std::string& name, const T& value, const std::string& unit, const std::string& help, const Rest&...) {
        text += fmt::format("{} = {}  # {}{}{}\n", name, value, unit, unit.empty() ? "" : ", ", help);
    }
    void operator()(const std::string& name, const std::string& value, const std::string& unit, const std::string& help, std::initializer_list<const char*>) {
        operator()<std::string>(name, value, unit, help);
    }
};

} // namespace

void SensorInfo::set_pose(const Vec3& position, const Quat& attitude) {
    std::tie(x, y, z) = std::tuple(position.x(), position.y(), position.z());
    std::tie(qw, qx, qy, qz) = std::tuple(attitude.w(), attitude.x(), attitude.y(), attitude.z());
}

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

void write_sensor_info(const std::filesystem::path& path, SensorInfo info) {
    InfoLines lines;
    info.describe(lines);
    write_whole(path, lines.text);
}

void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings, const std::vector<std::string>& comments) {
    const auto all_have = [&](auto channel) { return std::ranges::none_of(recordings, [&](const Recording& r) { return (r.*channel).empty(); }); };
    const bool strain = all_have(&Recording::strain), sequence = all_have(&Recording::sequence), force = all_have(&Recording::force),
               rate = all_have(&Recording::rate), displacement = all_have(&Recording::displacement), attitude = all_have(&Recording::attitude);
    std::vector<std::string> names{"t", "id"};
    const auto name = [&](bool there, std::initializer_list<const char*> columns) {
        if (there) names.insert(names.end(), columns.begin(), columns.end());
    };
    name(sequence, {"seq"});
    name(strain, {"strain"});
    name(force, {"ax", "ay", "az"});
    name(rate, {"gx", "gy", "gz"});
    name(displacement, {"ux", "uy", "uz"});
    name(attitude, {"qw", "qx", "qy", "qz"});
    std::vector<std::vector<double>> rows;
    for (const Recording& r : recordings)
        for (std::size_t k = 0; k < r.size(); ++k) {
            std::vector<double> row{r.time[k], static_cast<double>(r.info.id)};
            const auto put = [&](bool there, const auto& values) {
                if (there) row.insert(row.end(), values.begin(), values.end());
            };
            if (sequence) row.push_back(static_cast<double>(r.sequence[k]));
            if (strain) row.push_back(r.strain[k]);
            if (force) put(true, r.info.recorded_force(r.force[k]));
            if (rate) put(true, r.info.recorded_rate(r.rate[k]));
            if (displacement) put(true, r.displacement[k]);
            if (attitude) put(true, std::array{r.attitude[k].w(), r.attitude[k].x(), r.attitude[k].y(), r.attitude[k].z()});
            rows.push_back(std::move(row));
        }
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row[0]; });
    write_csv(csv, names, rows, comments, 7);
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
        r.time.push_back(time[row]);
        if (sequence.present) r.sequence.push_back(count_of(table, row, "seq", sequence(row)[0]));
        if (strain.present) r.strain.push_back(strain(row)[0]);
        if (force.present) r.force.push_back(r.info.force_of(force(row)));
        if (rate.present) r.rate.push_back(r.info.rate_of(rate(row)));
        if (displacement.present) r.displacement.push_back(displacement(row));
        if (attitude.present) {
            const auto q = attitude(row);
            r.attitude.emplace_back(q[0], q[1], q[2], q[3]);
        }
    }
    return recordings;
}

} // namespace bris
