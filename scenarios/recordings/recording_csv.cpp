#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "scenarios/recordings/device_channels.hpp"
#include "scenarios/recordings/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace bris {

namespace {

/// The columns of a vector: all of them, or none.
template <std::size_t N>
struct Channel {
    std::array<std::vector<double>, N> columns;
    bool present = false;

    Channel(const CsvTable& table, const std::array<const char*, N>& names) {
        const auto there =
            std::ranges::count_if(names, [&](const char* name) { return table.has(name); });
        present = there > 0;
        if (!present) return;
        for (std::size_t k = 0; k < N; ++k)
            columns[k] = table.column(names[k]); // throws with the name of a missing column
    }
    Eigen::Matrix<double, N, 1> operator()(std::size_t row) const {
        Eigen::Matrix<double, N, 1> v;
        for (std::size_t k = 0; k < N; ++k) v[static_cast<Eigen::Index>(k)] = columns[k][row];
        return v;
    }
};

std::string at_line(const CsvTable& table, std::size_t row) {
    return fmt::format("{}:{}", table.path.string(), table.lines[row]);
}

/// A non-negative whole number of a column.
std::uint64_t count_of(const CsvTable& table, std::size_t row, const char* name, double value) {
    if (!is_count(value))
        throw InputError(fmt::format("{}: {}: expected a non-negative whole number, found {}",
                                     at_line(table, row), name, value));
    return static_cast<std::uint64_t>(value);
}

/// The unit that a form gives for all columns of a channel; "": none. Throws InputError if it gives
/// units for some of them only.
std::string given_unit(const CsvForm& form, std::initializer_list<const char*> names) {
    const CsvColumn* with = nullptr;
    const CsvColumn* without = nullptr;
    for (const char* name : names)
        if (const CsvColumn* column = form.find(name))
            (column->unit.empty() ? without : with) = column;
    if (with != nullptr && without != nullptr)
        throw InputError(fmt::format("{}: {}: expected a unit, as for {}, found none",
                                     without->where, without->ours, with->ours));
    return with == nullptr ? "" : with->unit;
}

/// Where a form gives units, the numbers have been converted on reading.
SensorInfo with_units_of(SensorInfo info, const CsvForm& form) {
    if (!given_unit(form, {"ax", "ay", "az"}).empty()) info.force_unit = std::string("m/s2");
    if (!given_unit(form, {"gx", "gy", "gz"}).empty()) info.rate_unit = "rad/s";
    if (!given_unit(form, {"mx", "my", "mz"}).empty()) info.field_unit = std::string("T");
    (void)given_unit(form, {"ux", "uy", "uz"});
    for (const DeviceChannel& channel : device_channels()) {
        const std::string given = given_unit(form, {channel.column});
        const auto unit = std::ranges::find(channel.units, given, &ColumnUnit::name);
        if (unit == channel.units.end()) continue;
        const bool is_converted = unit->scale != 1 || unit->offset != 0;
        info.*channel.unit = is_converted ? channel.units.front().name : given;
    }
    return info;
}

/// The columns of all recordings, read row by row.
class Columns {
public:
    explicit Columns(const CsvTable& table)
        : table_(table), force_(table, {"ax", "ay", "az"}), rate_(table, {"gx", "gy", "gz"}),
          displacement_(table, {"ux", "uy", "uz"}), field_(table, {"mx", "my", "mz"}),
          attitude_(table, {"qw", "qx", "qy", "qz"}), sequence_(table, {"seq"}),
          flags_(table, {"flags"}), strain_(table, {"strain"}), phase_(table, {"phase"}) {
        for (const DeviceChannel& channel : device_channels())
            device_.push_back(Channel<1>(table, {channel.column}));
    }

    void append(std::size_t row, double time, Recording& r) const {
        if (flags_.present)
            r.flags.push_back(
                std::isnan(flags_(row)[0]) ? 0 : count_of(table_, row, "flags", flags_(row)[0]));
        const bool used = r.flags.empty() || !r.info.leaves_out(r.flags.back());
        const auto take = [&](const auto& channel, const char* name, auto&& keep) {
            if (!channel.present) return;
            const auto values = channel(row);
            if (used && !values.allFinite()) r.look_for_numbers(name, values, at_line(table_, row));
            keep(values);
        };
        r.time.push_back(time);
        if (used && !std::isfinite(time)) r.first_without.emplace("t", at_line(table_, row));
        if (sequence_.present)
            r.sequence.push_back(count_of(table_, row, "seq", sequence_(row)[0]));
        take(strain_, "strain", [&](const auto& v) { r.strain.push_back(v[0]); });
        take(phase_, "phase", [&](const auto& v) { r.phase.push_back(v[0]); });
        take(force_, "ax ay az", [&](const auto& v) { r.force.push_back(r.info.force_of(v)); });
        take(rate_, "gx gy gz", [&](const auto& v) { r.rate.push_back(r.info.rate_of(v)); });
        take(field_, "mx my mz", [&](const auto& v) { r.field.push_back(r.info.field_of(v)); });
        take(displacement_, "ux uy uz", [&](const auto& v) { r.displacement.push_back(v); });
        take(attitude_, "qw qx qy qz",
             [&](const auto& q) { r.attitude.emplace_back(q[0], q[1], q[2], q[3]); });
        for (std::size_t k = 0; k < device_.size(); ++k) {
            const DeviceChannel& channel = device_channels()[k];
            take(device_[k], channel.column, [&](const auto& v) {
                (r.*channel.values).push_back(channel.value_of_file(r.info, v[0]));
            });
        }
    }

private:
    const CsvTable& table_;
    Channel<3> force_, rate_, displacement_, field_;
    Channel<4> attitude_;
    Channel<1> sequence_, flags_, strain_, phase_;
    std::vector<Channel<1>> device_; // in the order of device_channels
};

} // namespace

const std::vector<KnownColumn>& recording_columns() {
    using Units = std::vector<ColumnUnit>;
    static const std::vector<KnownColumn> all = [] {
        constexpr double degree = pi / 180, g = standard_gravity;
        std::vector<KnownColumn> columns;
        const auto add = [&](std::initializer_list<const char*> names, const Units& units,
                             bool needed = false) {
            for (const char* name : names) columns.push_back({name, units, needed});
        };
        add({"t"}, Units{{"s"}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60}, {"h", 3600}},
            true);
        add({"id"}, {}, true);
        add({"seq", "flags"}, {});
        add({"strain"}, Units{{"1"}, {"%", 0.01}});
        add({"phase"}, Units{{"cycles"}, {"deg", 1.0 / 360}, {"rad", 0.5 / pi}});
        add({"ax", "ay", "az"}, Units{{"m/s2"}, {"g", g}, {"mg", 1e-3 * g}});
        add({"gx", "gy", "gz"}, Units{{"rad/s"},
                                      {"mrad/s", 1e-3},
                                      {"deg/s", degree},
                                      {"mdeg/s", 1e-3 * degree},
                                      {"rpm", 6 * degree}});
        add({"mx", "my", "mz"},
            Units{{"T"}, {"mT", 1e-3}, {"uT", 1e-6}, {"nT", 1e-9}, {"G", 1e-4}, {"mG", 1e-7}});
        add({"ux", "uy", "uz"}, Units{{"m"}, {"mm", 1e-3}, {"um", 1e-6}});
        add({"qw", "qx", "qy", "qz"}, {});
        for (const DeviceChannel& channel : device_channels()) add({channel.column}, channel.units);
        return columns;
    }();
    return all;
}

void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings,
                      const std::vector<std::string>& comments) {
    const auto all_have = [&](auto channel) {
        return std::ranges::none_of(recordings,
                                    [&](const Recording& r) { return (r.*channel).empty(); });
    };
    const bool strain = all_have(&Recording::strain), sequence = all_have(&Recording::sequence),
               force = all_have(&Recording::force), rate = all_have(&Recording::rate),
               displacement = all_have(&Recording::displacement),
               attitude = all_have(&Recording::attitude), phase = all_have(&Recording::phase),
               field = all_have(&Recording::field);
    std::vector<DeviceChannel> device = device_channels();
    std::erase_if(device, [&](const DeviceChannel& c) { return !all_have(c.values); });
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
    name(phase, {"phase"});
    name(field, {"mx", "my", "mz"});
    for (const DeviceChannel& channel : device) name(true, {channel.column});
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
            if (attitude)
                put(true, std::array{r.attitude[k].w(), r.attitude[k].x(), r.attitude[k].y(),
                                     r.attitude[k].z()});
            if (phase) row.push_back(r.phase[k]);
            if (field) put(true, r.info.recorded_field(r.field[k]));
            for (const DeviceChannel& channel : device)
                row.push_back(channel.file_value_of(r.info, (r.*channel.values)[k]));
            rows.push_back(std::move(row));
        }
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row[0]; });
    write_csv(csv, names, rows, comments, 7);
}

std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors) {
    return read_recordings(csv, sensors, CsvForm{});
}

std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors,
                                       const CsvForm& form) {
    std::vector<Recording> recordings;
    std::map<std::uint64_t, std::size_t> where;
    for (const SensorInfo& info : sensors) {
        require(where.emplace(info.id, recordings.size()).second,
                fmt::format("sensor {}: expected one metadata file, found two", info.id));
        recordings.emplace_back().info = with_units_of(info, form);
    }
    const CsvTable table = read_csv(csv, form);
    const auto unused = table.others(titles_of(recording_columns(), form));
    const auto time = table.column("t"), id = table.column("id");
    const Columns columns(table);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto found = where.find(count_of(table, row, "id", id[row]));
        if (found == where.end())
            throw InputError(fmt::format("{}: id: expected the id of a metadata file, found {}",
                                         at_line(table, row), id[row]));
        columns.append(row, time[row], recordings[found->second]);
    }
    for (Recording& r : recordings) {
        r.unused = unused;
        reject_flagged(r);
    }
    return recordings;
}

} // namespace bris
