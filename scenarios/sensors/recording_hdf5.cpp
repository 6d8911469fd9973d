#include "engine/errors.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/hdf5_recordings.hpp"
#include "scenarios/sensors/sensor_info_options.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

namespace bris {

namespace {

/// Components of each sample, one after the other; empty if the file does not have the dataset.
std::span<const double> numbers_of(const Hdf5Content& file, const std::string& dataset,
                                   std::size_t samples, std::size_t components) {
    if (!file.has(dataset)) return {};
    const Hdf5File::Shape shape = file.shape(dataset),
                          wanted = components == 1 ? Hdf5File::Shape{samples}
                                                   : Hdf5File::Shape{samples, components};
    require(shape == wanted, fmt::format("{}: {}: expected {}, found {}", file.path().string(),
                                         dataset, in_words(wanted), in_words(shape)));
    return file.numbers(dataset);
}

/// Reads the attributes of a group as if they were typed as options, so that the same checks apply.
struct AttributeReader {
    const Hdf5Content& file;
    const std::string& group;
    std::vector<std::string> typed = {};
    void operator()(const std::string& name, const std::string&, auto&&...) {
        add(name, [&] {
            require(file.has_text(group, name),
                    fmt::format("{}: {}: {}: expected a text, found none", file.path().string(),
                                group, name));
            return file.text_attribute(group, name);
        });
    }
    void operator()(const std::string& name, const auto&, auto&&...) {
        add(name, [&] { return number(name); });
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

/// Name of the attribute with the unit of a dataset.
std::string unit_attribute(const Channel& channel) {
    return fmt::format("{}_unit", channel.names.dataset);
}

std::vector<std::string> unused_of(const Hdf5Content& file, const std::string& own) {
    std::set<std::string> used{"time"};
    for (const Channel& channel : all_channels) {
        used.emplace(channel.names.dataset);
        if (channel.unit != nullptr) used.insert("@" + unit_attribute(channel));
    }
    const auto use = [&](const std::string& name, auto&&...) { used.insert("@" + name); };
    SensorInfo().declare_options(use);
    return unused_in(file, own, used);
}

/// Refuses a group whose attributes state other units than the metadata, and datasets that do.
void require_units(const Hdf5Content& file, const std::string& own, const SensorInfo& info) {
    for (const Channel& channel : all_channels) {
        if (channel.unit == nullptr) continue;
        const std::string name = unit_attribute(channel), &unit = info.*channel.unit;
        const std::string found =
            file.has_attribute(own, name) ? file.text_attribute(own, name) : unit;
        require(found == unit, fmt::format("{}: {}: {}: expected {} as in the metadata, found {}",
                                           file.path().string(), own, name, unit, found));
    }
    const std::vector<ColumnUnit>& of_time = recording_columns().front().units;
    require_unit(file, own + "/time", of_time.front().name, of_time);
    for (const Channel* channel : channels_by_kind)
        if (const auto units = channel->column_units(); !units.empty())
            require_unit(file, fmt::format("{}/{}", own, channel->names.dataset),
                         channel->unit == nullptr ? units.front().name : info.*channel->unit,
                         units);
}

/// Reads counts as doubles: read as integers, a negative number or NaN would become another count.
std::vector<std::uint64_t> counts_of(const Hdf5Content& file, const std::string& dataset,
                                     std::size_t samples, bool nan_is_0) {
    std::vector<std::uint64_t> counts;
    const auto numbers = numbers_of(file, dataset, samples, 1);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const double n = nan_is_0 && std::isnan(numbers[k]) ? 0 : numbers[k];
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

void write_channel(Hdf5File& file, const std::string& group, const Channel& channel,
                   const Recording& r) {
    const std::size_t samples = channel.samples(r), width = channel.size();
    if (samples == 0 || channel.is(Channel::unwritten)) return;
    const std::string dataset = fmt::format("{}{}", group, channel.names.dataset);
    if (channel.is_count()) // not as numbers with a fraction
        return file.write(dataset, std::span(r.sequence));
    std::vector<double> numbers;
    for (std::size_t k = 0; k < samples; ++k) {
        const auto sample = channel.in_file(r, k);
        const auto used = std::span(sample).first(width);
        numbers.insert(numbers.end(), used.begin(), used.end());
    }
    file.write(dataset, std::span<const double>(numbers),
               width == 1 ? Hdf5File::Shape{samples} : Hdf5File::Shape{samples, width});
}

Recording read_one(const Hdf5Content& file, const SensorInfo& info) {
    const std::string own = fmt::format("/sensors/{}", info.id), group = own + "/";
    Recording r;
    r.info = info;
    if (!file.has(group + "time")) return r; // this sensor recorded nothing
    require_units(file, own, info);
    r.unused = unused_of(file, own);
    r.time = times_of(file, group + "time");
    const std::size_t samples = r.size();
    r.sequence = counts_of(file, group + "sequence", samples, false);
    r.flags = counts_of(file, group + "flags", samples, true);
    const auto note_without = [&](std::string_view columns, std::string_view dataset,
                                  std::size_t k) {
        if (r.flags.empty() || !info.leaves_out(r.flags[k]))
            r.first_without.emplace(
                columns, fmt::format("{}: {}{}[{}]", file.path().string(), group, dataset, k));
    };
    for (std::size_t k = 0; k < samples; ++k)
        if (!std::isfinite(r.time[k])) note_without("t", "time", k);
    for (const Channel* channel : channels_by_kind) {
        if (channel->is_count()) continue;
        const auto all = numbers_of(file, fmt::format("{}{}", group, channel->names.dataset),
                                    samples, channel->size());
        for (std::size_t k = 0; k * channel->size() < all.size(); ++k) {
            const auto numbers = all.subspan(k * channel->size(), channel->size());
            if (!are_finite(numbers))
                note_without(channel->names.columns, channel->names.dataset, k);
            channel->append(r, numbers.data());
        }
    }
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
        info.declare_options(reader);
        Options options;
        info.declare_options(options);
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
        for (const Channel* channel : channels_by_kind) write_channel(file, group, *channel, r);
        SensorInfo info = r.info;
        const auto put = [&](const std::string& name, const auto& value, auto&&...) {
            file.set_attribute(own, name, value);
        };
        info.declare_options(put);
        for (const Channel& channel : all_channels)
            if (channel.unit != nullptr)
                file.set_attribute(own, unit_attribute(channel), info.*channel.unit);
    }
    file.close();
}

} // namespace bris
