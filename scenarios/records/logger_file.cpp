#include "scenarios/records/logger_file.hpp"

#include "engine/errors.hpp"
#include "engine/printable.hpp"
#include "scenarios/records/first_force.hpp"
#include "scenarios/records/logged_clock.hpp"
#include "scenarios/records/sensor_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace bris {

namespace {

class LoggerReader {
public:
    LoggerReader(const std::filesystem::path& file, const LoggerSettings& settings)
        : path_(file), settings_(settings) {}

    LoggerFile read() {
        const auto rows = read_rows();
        const std::vector<unsigned> ids = ids_of(rows);
        result_.is_absolute = columns_.is_absolute;
        for (std::size_t s = 0; s < rows.size(); ++s)
            if (rows[s].time.size() < 2)
                note(fmt::format("Left out: sensor \"{}\" with a single sample.", rows[s].name));
            else
                add(rows[s], ids[s]);
        require(!result_.recordings.empty(),
                fmt::format("{}: expected at least two samples of a sensor, found {}",
                            path_.string(), rows.empty() ? "none" : "one of each"));
        for (const Recording& r : result_.recordings)
            require(std::ranges::count(result_.recordings, r.info.id, id_of) == 1,
                    fmt::format("{}: expected another number for each sensor, found {} twice",
                                path_.string(), r.info.id));
        std::ranges::sort(result_.recordings, {}, id_of);
        describe_times();
        for (std::string& text : result_.notes) text = printable(text);
        return std::move(result_);
    }

private:
    static unsigned id_of(const Recording& r) { return r.info.id; }
    void note(std::string text) { result_.notes.push_back(std::move(text)); }

    std::vector<LoggedRows> read_rows() {
        CsvForm form;
        if (!settings_.columns.empty()) form = form_of_logger(settings_.columns);
        const LoggerTable table =
            find_logger_table(path_, settings_.columns.empty() ? nullptr : &form);
        columns_ = find_logger_columns(table, settings_, result_.notes);
        require(columns_.form != LoggedTime::none || columns_.rate > 0,
                fmt::format("{}: expected a column of times or a sampling rate, found neither "
                            "among {}; add --rate HZ, or write dates as 2024-05-07 10:00:00.005",
                            path_.string(), table.columns()));
        return read_logged_rows(table, columns_, result_.notes);
    }

    std::vector<unsigned> ids_of(const std::vector<LoggedRows>& rows) {
        if (columns_.id) return ids_in_column(rows);
        std::vector<unsigned> ids;
        for (const LoggedRows& r : rows) ids.push_back(r.number);
        if (rows.size() > 1) {
            note("The numbers of the sensors are those in the names of the columns.");
            return ids;
        }
        const auto number = number_in_name(path_);
        result_.has_id = number.has_value();
        note(number ? fmt::format("The file is of one sensor, {}, by its name.", *number)
                    : std::string("The file is of one sensor, which is called 1."));
        return std::vector<unsigned>(rows.size(), number.value_or(1));
    }

    std::vector<unsigned> ids_in_column(const std::vector<LoggedRows>& rows) {
        std::vector<std::string> names;
        std::vector<unsigned> ids;
        for (const LoggedRows& r : rows) {
            names.push_back(r.name);
            double number = 0;
            const char* const end = r.name.data() + r.name.size();
            const auto [stop, error] = std::from_chars(r.name.data(), end, number);
            if (error == std::errc{} && stop == end && is_count(number) && number < 1e6)
                ids.push_back(static_cast<unsigned>(number));
        }
        if (ids.size() == rows.size()) return ids;
        ids = numbers_of_names(names);
        std::string text;
        for (std::size_t k = 0; k < std::min<std::size_t>(ids.size(), 20); ++k)
            text += fmt::format("{}{} is \"{}\"", k > 0 ? ", " : "", ids[k], names[k]);
        note("Sensors by their names: " + text + ".");
        return ids;
    }

    void add(LoggedRows rows, unsigned id) {
        const std::string sensor = fmt::format("Sensor {}", id);
        Recording r;
        r.info.id = id;
        r.info.sampling_rate =
            order_times(rows, columns_, settings_.rate > 0, path_.string(), sensor, result_.notes);
        if (rows.has_force && !rows.has_gravity) add_gravity(rows, sensor);
        if (rows.has_force && rows.has_gravity && rows.axes < 3)
            note(fmt::format("{}: {} of three axes were recorded, the others are 0: attitude and "
                             "tilt cannot be judged.",
                             sensor, rows.axes));
        r.time = std::move(rows.time);
        r.force = std::move(rows.force);
        r.rate = std::move(rows.rate);
        for (const double n : rows.counter) r.sequence.push_back(static_cast<std::uint64_t>(n));
        set_ranges(r, sensor);
        set_attitude_by_gravity(r);
        result_.recordings.push_back(std::move(r));
    }

    /// Code downstream takes the mean force at rest as vertical, which needs one.
    void add_gravity(LoggedRows& rows, const std::string& sensor) {
        result_.has_gravity = false;
        const auto axis = static_cast<Eigen::Index>(rows.upwards);
        for (Vec3& force : rows.force) force[axis] += standard_gravity;
        note(fmt::format("{}: the accelerations are without gravity; {} is taken as vertical, and "
                         "{:.5f} m/s2 are added along it: attitude, tilt and the unit by gravity "
                         "cannot be judged.",
                         sensor, "xyz"[rows.upwards], standard_gravity));
    }

    void set_ranges(Recording& r, const std::string& sensor) {
        for (const auto& [values, range, unit] : {std::tuple{&r.force, &r.info.force_range, "m/s2"},
                                                  {&r.rate, &r.info.rate_range, "rad/s"}}) {
            double most = 0;
            for (const Vec3& v : *values) most = std::max(most, v.cwiseAbs().maxCoeff());
            if (most < *range) continue;
            *range = 1.01 * most;
            note(fmt::format("{}: up to {:.4g} {} were recorded, which is taken as its range.",
                             sensor, most, unit));
        }
    }

    void describe_times() {
        const char* const from =
            columns_.form == LoggedTime::none
                ? columns_.counter ? "counted by the counter of samples" : "counted row by row"
            : columns_.is_absolute ? "those of the file, since 1970 (UTC)"
                                   : "those of the logger's clock";
        const auto& all = result_.recordings;
        const auto [low, high] = std::ranges::minmax(all, {}, rate_of);
        std::string rates = fmt::format("{:.6g}", low.info.sampling_rate);
        if (high.info.sampling_rate > 1.0001 * low.info.sampling_rate)
            rates += fmt::format(" to {:.6g}", high.info.sampling_rate);
        note(fmt::format("Times are {}; {} Hz.", from, rates));
    }
    static double rate_of(const Recording& r) { return r.info.sampling_rate; }

    std::filesystem::path path_;
    const LoggerSettings& settings_;
    LoggerColumns columns_;
    LoggerFile result_;
};

} // namespace

double begin_at_zero(std::vector<Recording>& recordings) {
    double first = HUGE_VAL;
    for (const Recording& r : recordings)
        if (r.size() > 0) first = std::min(first, r.time.front());
    for (Recording& r : recordings)
        for (double& t : r.time) t -= first;
    return first;
}

LoggerFile read_logger_file(const std::filesystem::path& file, const LoggerSettings& settings) {
    return LoggerReader(file, settings).read();
}

} // namespace bris
