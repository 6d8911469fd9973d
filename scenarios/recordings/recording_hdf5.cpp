#include "engine/errors.hpp"
#include "scenarios/recordings/device_channels.hpp"
#include "scenarios/recordings/hdf5_recordings.hpp"
#include "scenarios/recordings/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <type_traits>
#include <utility>

namespace bris {

namespace {

/// Rows of N numbers, one for each sample; empty if the file does not have the dataset.
template <std::size_t N>
std::vector<Eigen::Matrix<double, N, 1>> rows_of(const Hdf5Content& file,
                                                 const std::string& dataset, std::size_t samples) {
    std::vector<Eigen::Matrix<double, N, 1>> rows;
    if (!file.has(dataset)) return rows;
    const Hdf5File::Shape shape = file.shape(dataset),
                          wanted = N == 1 ? Hdf5File::Shape{samples} : Hdf5File::Shape{samples, N};
    require(shape == wanted, fmt::format("{}: {}: expected {}, found {}", file.path().string(),
                                         dataset, in_words(wanted), in_words(shape)));
    const auto& numbers = file.numbers(dataset);
    for (std::size_t k = 0; k < samples; ++k)
        rows.push_back(Eigen::Matrix<double, N, 1>::Map(&numbers[N * k]));
    return rows;
}

template <class Row>
void write_rows(Hdf5File& file, const std::string& dataset, const std::vector<Row>& rows) {
    if (rows.empty()) return;
    constexpr auto width = static_cast<std::uint64_t>(Row::SizeAtCompileTime);
    file.write(dataset, std::span<const double>(rows.front().data(), rows.size() * width),
               {rows.size(), width});
}

/// Writes the metadata as attributes of a group.
struct AttributeWriter {
    Hdf5File& file;
    const std::string& group;
    void operator()(const std::string& name, unsigned value, auto&&...) {
        file.set_attribute<std::uint32_t>(group, name, value);
    }
    void operator()(const std::string& name, double value, auto&&...) {
        file.set_attribute<double>(group, name, value);
    }
    void operator()(const std::string& name, const std::string& value, const std::string&,
                    const std::string&, std::initializer_list<const char*>) {
        file.set_attribute(group, name, value);
    }
};

/// Reads the attributes of a group as if they were typed as options, so that the same checks apply.
struct AttributeReader {
    const Hdf5Content& file;
    const std::string& group;
    std::vector<std::string> typed = {};
    void operator()(const std::string& name, unsigned, auto&&...) {
        add(name, [&] { return number(name); });
    }
    void operator()(const std::string& name, double, auto&&...) {
        add(name, [&] { return number(name); });
    }
    void operator()(const std::string& name, const std::string&, const std::string&,
                    const std::string&, std::initializer_list<const char*>) {
        add(name, [&] {
            require(file.has_text(group, name),
                    fmt::format("{}: {}: {}: expected a text, found none", file.path().string(),
                                group, name));
            return file.text_attribute(group, name);
        });
    }

private:
    std::string number(const std::string& name) const {
        if (file.has_text(group, name)) return file.text_attribute(group, name);
        const auto& numbers = file.attribute(group, name);
        require(numbers.size() == 1,
                fmt::format("{}: {}: {}: expected one number, found {}", file.path().string(),
                            group, name, numbers.size()));
        return fmt::format("{}", numbers.front());
    }
    void add(const std::string& name, auto&& text) {
        if (!file.has_attribute(group, name)) return;
        std::string flag = name;
        std::ranges::replace(flag, '_', '-');
        typed.push_back(fmt::format("--{}={}", flag, text()));
    }
};

/// Units of the datasets: name of the attribute, and unit of the metadata.
std::vector<std::pair<std::string, std::string>> units_of(const SensorInfo& info) {
    std::vector<std::pair<std::string, std::string>> units{{"accel_unit", info.force_unit},
                                                           {"gyro_unit", info.rate_unit},
                                                           {"mag_unit", info.field_unit}};
    for (const DeviceChannel& channel : device_channels())
        units.emplace_back(fmt::format("{}_unit", channel.dataset), info.*channel.unit);
    return units;
}

/// The datasets of a sensor with their columns in CSV files, whose first one states the units.
const std::vector<std::pair<std::string, std::string>>& datasets() {
    static const auto all = [] {
        std::vector<std::pair<std::string, std::string>> list{
            {"time", "t"},          {"accel", "ax"},   {"gyro", "gx"},       {"mag", "mx"},
            {"displacement", "ux"}, {"quat", "qw"},    {"strain", "strain"}, {"phase", "phase"},
            {"sequence", "seq"},    {"flags", "flags"}};
        for (const DeviceChannel& channel : device_channels())
            list.emplace_back(channel.dataset, channel.column);
        return list;
    }();
    return all;
}

/// Collects the names of the metadata.
struct NameCollector {
    std::set<std::string>& names;
    void operator()(const std::string& name, auto&&...) { names.insert("@" + name); }
    void operator()(const std::string& name, const std::string&, const std::string&,
                    const std::string&, std::initializer_list<const char*>) {
        names.insert("@" + name);
    }
};

std::vector<std::string> unused_of(const Hdf5Content& file, const std::string& own,
                                   const SensorInfo& info) {
    std::set<std::string> used;
    for (const auto& [dataset, column] : datasets()) used.insert(dataset);
    for (const auto& [name, unit] : units_of(info)) used.insert("@" + name);
    NameCollector collector{used};
    SensorInfo named;
    named.describe(collector);
    return unused_in(file, own, used);
}

/// Refuses datasets that state another unit than that of the metadata.
void require_units(const Hdf5Content& file, const std::string& group, const SensorInfo& info) {
    std::map<std::string, std::string> units; // by dataset, where not the first of its column
    for (const auto& [name, unit] : units_of(info))
        units[name.substr(0, name.size() - std::string("_unit").size())] = unit;
    for (const auto& [dataset, column] : datasets()) {
        const auto known = std::ranges::find(recording_columns(), column, &KnownColumn::name);
        if (known->units.empty()) continue;
        const auto own = units.find(dataset);
        require_unit(file, group + dataset,
                     own == units.end() ? known->units.front().name : own->second, known->units);
    }
}

/// Reads counts as doubles: read as integers, a negative number or NaN would become another count.
std::vector<std::uint64_t> counts_of(const Hdf5Content& file, const std::string& dataset,
                                     std::size_t samples, bool nan_is_0) {
    std::vector<std::uint64_t> counts;
    const auto rows = rows_of<1>(file, dataset, samples);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double n = nan_is_0 && std::isnan(rows[k][0]) ? 0 : rows[k][0];
        if (!is_count(n))
            throw InputError(
                fmt::format("{}: {}[{}]: expected a non-negative whole number, found {}",
                            file.path().string(), dataset, k, n));
        counts.push_back(static_cast<std::uint64_t>(n));
    }
    return counts;
}

/// Times of the samples.
std::vector<double> times_of(const Hdf5Content& file, const std::string& dataset) {
    const auto shape = file.shape(dataset);
    require(shape.size() == 1,
            fmt::format("{}: {}: expected a one-dimensional array of numbers, found {}",
                        file.path().string(), dataset, in_words(shape)));
    return file.numbers(dataset);
}

Recording read_one(const Hdf5Content& file, const SensorInfo& info) {
    const std::string own = fmt::format("/sensors/{}", info.id), group = own + "/";
    Recording r;
    r.info = info;
    if (!file.has(group + "time")) return r; // this sensor recorded nothing
    for (const auto& [name, unit] : units_of(info)) {
        const std::string found =
            file.has_attribute(own, name) ? file.text_attribute(own, name) : unit;
        require(found == unit, fmt::format("{}: {}: {}: expected {} as in the metadata, found {}",
                                           file.path().string(), own, name, unit, found));
    }
    require_units(file, group, info);
    r.unused = unused_of(file, own, info);
    r.time = times_of(file, group + "time");
    const std::size_t samples = r.size();
    r.sequence = counts_of(file, group + "sequence", samples, false);
    r.flags = counts_of(file, group + "flags", samples, true);
    const auto look = [&](const char* dataset, const char* channel, std::size_t k,
                          const auto& numbers) {
        if (numbers.allFinite() || (!r.flags.empty() && info.leaves_out(r.flags[k]))) return;
        r.look_for_numbers(channel, numbers,
                           fmt::format("{}: {}{}[{}]", file.path().string(), group, dataset, k));
    };
    for (std::size_t k = 0; k < samples; ++k)
        look("time", "t", k, Eigen::Matrix<double, 1, 1>(r.time[k]));
    const auto read = [&]<std::size_t N>(const char* dataset, const char* channel,
                                         std::integral_constant<std::size_t, N>, auto&& keep) {
        const auto rows = rows_of<N>(file, group + dataset, samples);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            look(dataset, channel, k, rows[k]);
            keep(rows[k]);
        }
    };
    constexpr std::integral_constant<std::size_t, 1> number;
    constexpr std::integral_constant<std::size_t, 3> vector;
    constexpr std::integral_constant<std::size_t, 4> quaternion;
    read("accel", "ax ay az", vector, [&](const auto& v) { r.force.push_back(info.force_of(v)); });
    read("gyro", "gx gy gz", vector, [&](const auto& v) { r.rate.push_back(info.rate_of(v)); });
    read("mag", "mx my mz", vector, [&](const auto& v) { r.field.push_back(info.field_of(v)); });
    read("displacement", "ux uy uz", vector, [&](const auto& v) { r.displacement.push_back(v); });
    read("quat", "qw qx qy qz", quaternion,
         [&](const auto& q) { r.attitude.emplace_back(q[0], q[1], q[2], q[3]); });
    read("strain", "strain", number, [&](const auto& v) { r.strain.push_back(v[0]); });
    read("phase", "phase", number, [&](const auto& v) { r.phase.push_back(v[0]); });
    for (const DeviceChannel& channel : device_channels())
        read(channel.dataset, channel.column, number, [&](const auto& v) {
            (r.*channel.values).push_back(channel.value_of_file(info, v[0]));
        });
    reject_flagged(r);
    return r;
}

} // namespace

void require_unit(const Hdf5Content& file, const std::string& dataset, const std::string& unit,
                  const std::vector<ColumnUnit>& units) {
    for (const char* name : {"units", "unit"}) {
        if (!file.has_text(dataset, name)) continue;
        const std::string& found = file.text_attribute(dataset, name);
        require(found.empty() || unit_named(found, units) == unit,
                fmt::format("{}: {}: {}: expected {}, in which it is read, found {}",
                            file.path().string(), dataset, name, unit, found));
    }
}

std::vector<std::string> unused_in(const Hdf5Content& file, const std::string& group,
                                   const std::set<std::string>& used) {
    std::vector<std::string> unused;
    for (const std::string& name : file.names(group))
        if (!used.contains(name)) unused.push_back(name);
    for (const std::string& name : file.attribute_names(group))
        if (!used.contains("@" + name)) unused.push_back("@" + name);
    return unused;
}

std::vector<SensorInfo> read_sensor_infos_hdf5(const std::filesystem::path& path) {
    return sensor_infos_in(Hdf5Content::read(path, {"/sensors"}, Hdf5Content::Datasets::left_out));
}

std::vector<SensorInfo> sensor_infos_in(const Hdf5Content& file) {
    const std::filesystem::path& path = file.path();
    require(file.has("/sensors"),
            fmt::format("{}: expected a group /sensors, found none", path.string()));
    std::vector<SensorInfo> infos;
    for (const std::string& name : file.names("/sensors")) {
        const std::string group = "/sensors/" + name;
        SensorInfo info;
        AttributeReader reader{file, group};
        info.describe(reader);
        Options options;
        info.describe(options);
        try {
            (void)options.parse(reader.typed);
        } catch (const InputError& e) {
            throw InputError(fmt::format("{}: {}: {}", path.string(), group, e.what()));
        }
        require(std::to_string(info.id) == name,
                fmt::format("{}: {}: expected an attribute id equal to its name, found {}",
                            path.string(), group, info.id));
        check_sensor_info(info, fmt::format("{}: {}", path.string(), group));
        infos.push_back(info);
    }
    std::ranges::sort(infos, {},
                      &SensorInfo::id); // the names are in alphabetical order: 10 before 2
    return infos;
}

std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path,
                                            const std::vector<SensorInfo>& sensors) {
    return recordings_in(Hdf5Content::read(path, {"/sensors"}), sensors);
}

std::vector<Recording> recordings_in(const Hdf5Content& file,
                                     const std::vector<SensorInfo>& sensors) {
    const std::filesystem::path& path = file.path();
    require(file.has("/sensors"),
            fmt::format("{}: expected a group /sensors, found none", path.string()));
    for (const std::string& name : file.names("/sensors"))
        require(std::ranges::any_of(
                    sensors, [&](const SensorInfo& s) { return std::to_string(s.id) == name; }),
                fmt::format("{}: /sensors/{}: expected the id of a metadata file, found {}",
                            path.string(), name, name));
    std::vector<Recording> recordings;
    for (const SensorInfo& info : sensors) {
        const auto same = [&](const Recording& r) { return r.info.id == info.id; };
        require(std::ranges::none_of(recordings, same),
                fmt::format("sensor {}: expected one metadata file, found two", info.id));
        recordings.push_back(read_one(file, info));
    }
    return recordings;
}

void write_recordings_hdf5(const std::filesystem::path& path,
                           const std::vector<Recording>& recordings) {
    Hdf5File file = Hdf5File::create(path);
    for (const Recording& r : recordings) {
        const std::string own = fmt::format("/sensors/{}", r.info.id), group = own + "/";
        file.make_group(own); // metadata are kept even if the sensor recorded nothing
        if (!r.time.empty()) file.write(group + "time", std::span<const double>(r.time));
        std::vector<Vec3> force, rate, field;
        for (const Vec3& f : r.force) force.push_back(r.info.recorded_force(f));
        for (const Vec3& w : r.rate) rate.push_back(r.info.recorded_rate(w));
        for (const Vec3& b : r.field) field.push_back(r.info.recorded_field(b));
        std::vector<Eigen::Vector4d> attitude;
        for (const Quat& q : r.attitude) attitude.emplace_back(q.w(), q.x(), q.y(), q.z());
        write_rows(file, group + "accel", force);
        write_rows(file, group + "gyro", rate);
        write_rows(file, group + "mag", field);
        write_rows(file, group + "displacement", r.displacement);
        write_rows(file, group + "quat", attitude);
        const auto write = [&](const char* dataset, const auto& numbers) {
            if (!numbers.empty()) file.write(group + dataset, std::span(numbers));
        };
        write("strain", r.strain);
        write("phase", r.phase);
        for (const DeviceChannel& channel : device_channels()) {
            std::vector<double> numbers;
            for (const double value : r.*channel.values)
                numbers.push_back(channel.file_value_of(r.info, value));
            write(channel.dataset, numbers);
        }
        write("sequence", r.sequence);
        SensorInfo info = r.info;
        AttributeWriter writer{file, own};
        info.describe(writer);
        for (const auto& [name, unit] : units_of(info)) file.set_attribute(own, name, unit);
    }
    file.close();
}

} // namespace bris
