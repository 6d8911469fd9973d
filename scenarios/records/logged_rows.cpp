#include "scenarios/records/logged_rows.hpp"

#include "engine/errors.hpp"
#include "scenarios/records/date_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace bris {

namespace {

constexpr double largest_force = 1e6, largest_rate = 1e5; ///< m/s2, rad/s, of any sensor
constexpr double largest_time = 1e11;                     ///< s
constexpr double largest_share_of_damage = 0.05;
constexpr std::size_t most_sensors = 1000;

class RowReader {
public:
    RowReader(const LoggerTable& table, const LoggerColumns& columns,
              std::vector<std::string>& notes)
        : table_(table), columns_(columns), notes_(notes) {}

    std::vector<LoggedRows> read() {
        std::size_t rows = 0;
        table_.each_row([&](std::size_t line, const std::vector<std::string_view>& cells) {
            ++rows;
            if (const std::string why = take(cells); !why.empty() && damaged_++ == 0)
                first_ = {line, why};
            return true;
        });
        if (damaged_ > 0) report_damage(rows);
        return std::move(all_);
    }

private:
    void report_damage(std::size_t rows) {
        const double share = static_cast<double>(damaged_) / static_cast<double>(rows);
        if (share > largest_share_of_damage)
            throw InputError(fmt::format("{}:{}: {}, as in {} of {} rows; found {}; take these "
                                         "rows out, or give the columns with --axes",
                                         table_.path.string(), first_.first, first_.second,
                                         damaged_, rows, table_.columns()));
        notes_.push_back(fmt::format("Left out: {} of {} rows that cannot be read, the first in "
                                     "line {}: {}.",
                                     damaged_, rows, first_.first, first_.second));
    }

    /// Adds a row. Returns what is wrong with it; empty: nothing.
    std::string take(const std::vector<std::string_view>& cells) {
        if (cells.size() != table_.width)
            return fmt::format("expected {} columns, found {}", table_.width, cells.size());
        const auto time = time_in(cells);
        if (!time)
            return fmt::format("expected a time in {}, found \"{}\"",
                               table_.described(columns_.time.index), cells[columns_.time.index]);
        double counter = 0;
        if (columns_.counter) {
            counter = table_.number(cells[*columns_.counter]).value_or(-1);
            if (!is_count(counter))
                return fmt::format("expected a whole number in {}, found \"{}\"",
                                   table_.described(*columns_.counter), cells[*columns_.counter]);
        }
        const std::string_view name = columns_.id ? cells[*columns_.id] : "";
        if (columns_.id && name.empty())
            return fmt::format("expected a sensor in {}, found \"\"",
                               table_.described(*columns_.id));
        std::vector<Vec3> vectors;
        for (const LoggerAxes& axes : columns_.sensors)
            for (const auto& [part, most] :
                 {std::pair{&axes.force, largest_force}, std::pair{&axes.rate, largest_rate}}) {
                vectors.push_back(Vec3::Zero());
                for (std::size_t k = 0; k < 3; ++k) {
                    if (!(*part)[k]) continue;
                    const LoggerColumn& column = *(*part)[k];
                    const double x =
                        column.scale * table_.number(cells[column.index]).value_or(std::nan(""));
                    if (!(std::abs(x) < most))
                        return fmt::format("expected a number in {}, found \"{}\"",
                                           table_.described(column.index), cells[column.index]);
                    vectors.back()[static_cast<Eigen::Index>(k)] = x;
                }
            }
        return append(name, *time, counter, vectors);
    }

    std::string append(std::string_view name, double time, double counter,
                       const std::vector<Vec3>& vectors) {
        auto where = by_name_.find(name);
        if (where == by_name_.end()) {
            if (by_name_.size() >= most_sensors) return "expected at most 1000 sensors, found more";
            where = by_name_.emplace(std::string(name), all_.size()).first;
            for (const LoggerAxes& axes : columns_.sensors) all_.push_back(rows_of(axes, name));
        }
        for (std::size_t s = 0; s < columns_.sensors.size(); ++s) {
            LoggedRows& rows = all_[where->second + s];
            rows.time.push_back(time);
            if (columns_.counter) rows.counter.push_back(counter);
            if (rows.has_force) rows.force.push_back(vectors[2 * s]);
            if (rows.has_rate) rows.rate.push_back(vectors[2 * s + 1]);
        }
        return {};
    }

    static LoggedRows rows_of(const LoggerAxes& axes, std::string_view name) {
        LoggedRows rows;
        rows.name = name;
        rows.number = axes.number;
        rows.has_gravity = axes.has_gravity;
        rows.has_force = axes.has_force();
        rows.has_rate = axes.has_rate();
        for (std::size_t k = 0; k < 3; ++k)
            rows.axes += static_cast<std::size_t>(axes.force[k].has_value());
        if (rows.axes == 1)
            for (std::size_t k = 0; k < 3; ++k)
                if (axes.force[k]) rows.upwards = k;
        return rows;
    }

    /// s; NaN without times; nothing: it cannot be read.
    std::optional<double> time_in(const std::vector<std::string_view>& cells) {
        if (columns_.form == LoggedTime::none) return std::numeric_limits<double>::quiet_NaN();
        const std::string_view cell = cells[columns_.time.index];
        double t = 0;
        if (columns_.form == LoggedTime::number) {
            t = columns_.time.scale * table_.number(cell).value_or(std::nan(""));
        } else {
            const auto date = date_in(cell);
            if (!date || date->has_date != (columns_.form == LoggedTime::date)) return {};
            t = date->seconds;
        }
        if (columns_.form == LoggedTime::day_and_time) {
            const auto day = date_in(cells[columns_.day]);
            if (!day || !day->has_date) return {};
            t += day->seconds;
        }
        if (!(std::abs(t) < largest_time)) return {};
        if (columns_.form == LoggedTime::time_of_day) {
            constexpr double a_day = 86400;
            if (t + days_ < last_ - 0.5 * a_day) days_ += a_day; // past midnight
            last_ = t += days_;
        }
        return t;
    }

    const LoggerTable& table_;
    const LoggerColumns& columns_;
    std::vector<std::string>& notes_;
    std::vector<LoggedRows> all_;
    std::map<std::string, std::size_t, std::less<>> by_name_; // first of the sensors of a name
    std::size_t damaged_ = 0;
    std::pair<std::size_t, std::string> first_; // line, and what is wrong
    double days_ = 0, last_ = 0;                // s, of times of day
};

} // namespace

std::vector<LoggedRows> read_logged_rows(const LoggerTable& table, const LoggerColumns& columns,
                                         std::vector<std::string>& notes) {
    return RowReader(table, columns, notes).read();
}

} // namespace bris
