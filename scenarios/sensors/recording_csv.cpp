#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "scenarios/sensors/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

namespace bris {

namespace {

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

/// Where a form gives units, the numbers have been converted on reading. Throws InputError if it
/// gives units for some columns of a channel only.
SensorInfo with_units_of(SensorInfo info, const CsvForm& form) {
    for (const Channel& channel : all_channels) {
        const CsvColumn* with = nullptr;
        const CsvColumn* without = nullptr;
        for (std::size_t k = 0; k < channel.size(); ++k)
            if (const CsvColumn* column = form.find(std::string(channel.column(k))))
                (column->unit.empty() ? without : with) = column;
        if (with != nullptr && without != nullptr)
            throw InputError(fmt::format("{}: {}: expected a unit, as for {}, found none",
                                         without->where, without->ours, with->ours));
        if (channel.unit == nullptr || with == nullptr) continue;
        const bool is_converted = std::abs(with->scale) != 1 || with->offset != 0; // -: a sign
        info.*channel.unit = is_converted ? channel.units.front().name : with->unit;
    }
    return info;
}

/// Significant digits with which the latest times are exact to a hundredth of an interval; at
/// least 7.
int digits_for(const std::vector<Recording>& recordings) {
    double intervals = 1;
    for (const Recording& r : recordings)
        for (const double t : r.time)
            if (std::isfinite(t))
                intervals = std::max(intervals, std::abs(t) * r.info.sampling_rate);
    return static_cast<int>(std::clamp(std::ceil(std::log10(100 * intervals)), 7.0, 15.0));
}

/// The columns of all recordings, read row by row.
class Columns {
public:
    explicit Columns(const CsvTable& table) : table_(table) {
        const auto is_there = [&](std::string_view name) { return table.has(std::string(name)); };
        for (const Channel& channel : all_channels) {
            const auto names = std::span(channel_columns).subspan(channel.place, channel.size());
            if (std::ranges::none_of(names, is_there)) continue;
            for (std::size_t k = 0; k < names.size(); ++k) // throws if a component is missing
                columns_[channel.place + k] = table.column(std::string(names[k]));
        }
    }

    void append(std::size_t row, double time, Recording& r) const {
        const auto &flags = column(&Recording::flags), &sequence = column(&Recording::sequence);
        if (!flags.empty())
            r.flags.push_back(std::isnan(flags[row]) ? 0
                                                     : count_of(table_, row, "flags", flags[row]));
        const bool used = r.flags.empty() || !r.info.leaves_out(r.flags.back());
        r.time.push_back(time);
        if (used && !std::isfinite(time)) r.first_without.emplace("t", at_line(table_, row));
        if (!sequence.empty()) r.sequence.push_back(count_of(table_, row, "seq", sequence[row]));
        for (const Channel& channel : all_channels) {
            if (columns_[channel.place].empty() || channel.is_count()) continue;
            std::array<double, 4> numbers{};
            for (std::size_t k = 0; k < channel.size(); ++k)
                numbers[k] = columns_[channel.place + k][row];
            if (used && !are_finite(numbers))
                r.first_without.emplace(channel.names.columns, at_line(table_, row));
            channel.append(r, numbers.data());
        }
    }

private:
    const std::vector<double>& column(Channel::Series series) const {
        return columns_[place_of(series)];
    }

    const CsvTable& table_;
    std::array<std::vector<double>, channel_columns.size()> columns_; // empty: not there
};

} // namespace

const std::vector<KnownColumn>& recording_columns() {
    using Units = std::vector<ColumnUnit>;
    static const std::vector<KnownColumn> all = [] {
        std::vector<KnownColumn> columns{
            {"t", Units{{"s"}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60}, {"h", 3600}},
             true},
            {"id", {}, true}};
        for (const Channel& channel : all_channels)
            for (std::size_t k = 0; k < channel.size(); ++k)
                columns.push_back({std::string(channel.column(k)), channel.column_units()});
        return columns;
    }();
    return all;
}

void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings,
                      const std::vector<std::string>& comments) {
    std::vector<const Channel*> written;
    for (const bool is_late : {false, true})
        for (const Channel& channel : all_channels)
            if (channel.is(Channel::late) == is_late && !channel.is(Channel::unwritten) &&
                std::ranges::all_of(recordings,
                                    [&](const Recording& r) { return channel.samples(r) > 0; }))
                written.push_back(&channel);
    std::vector<std::string> names{"t", "id"};
    for (const Channel* channel : written)
        for (std::size_t k = 0; k < channel->size(); ++k) names.emplace_back(channel->column(k));
    std::vector<std::vector<double>> rows;
    for (const Recording& r : recordings)
        for (std::size_t k = 0; k < r.size(); ++k) {
            std::vector<double> row{r.time[k], static_cast<double>(r.info.id)};
            for (const Channel* channel : written) {
                const auto numbers = channel->in_file(r, k);
                const auto used = std::span(numbers).first(channel->size());
                row.insert(row.end(), used.begin(), used.end());
            }
            rows.push_back(std::move(row));
        }
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row[0]; });
    write_csv(csv, names, rows, comments, digits_for(recordings));
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
