#include "scenarios/records/logged_clock.hpp"

#include "engine/errors.hpp"
#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double least_rate = 1e-4, most_rate = 1e6; ///< Hz

/// Keeps the rows for which it is said.
void keep(LoggedRows& rows, const std::vector<char>& is_kept) {
    const auto shorten = [&](auto& values) {
        if (values.empty()) return;
        std::size_t kept = 0;
        for (std::size_t k = 0; k < is_kept.size(); ++k)
            if (is_kept[k]) values[kept++] = values[k];
        values.resize(kept);
    };
    shorten(rows.time);
    shorten(rows.counter);
    shorten(rows.force);
    shorten(rows.rate);
}

/// Mean of the intervals that are neither gaps nor much shorter than usual, s: a clock of whole
/// milliseconds shows 3, 3, 4 at 300 Hz.
double usual_interval(const std::vector<double>& time) {
    std::vector<double> intervals;
    for (std::size_t k = 1; k < time.size(); ++k) intervals.push_back(time[k] - time[k - 1]);
    const double middle = median(intervals);
    double sum = 0, count = 0;
    for (const double interval : intervals)
        if (interval > 0.5 * middle && interval < 1.5 * middle) sum += interval, count += 1;
    return count > 0 ? sum / count : middle;
}

class Clock {
public:
    Clock(LoggedRows& rows, const LoggerColumns& columns, bool is_rate_of_user,
          const std::string& file, const std::string& sensor, std::vector<std::string>& notes)
        : rows_(rows), stated_(columns.rate), is_timed_(columns.form != LoggedTime::none),
          is_rate_of_user_(is_rate_of_user), file_(file), sensor_(sensor), notes_(notes) {}

    double order() {
        unwrap_counter();
        if (!is_timed_) return count_times();
        leave_out_backwards();
        double rate = rate_of_repeated();
        if (!(rate > 0)) {
            leave_out_repeated();
            require_two();
            rate = 1 / usual_interval(rows_.time);
        }
        require(rate > least_rate && rate < most_rate,
                fmt::format("{}: {}: expected a sampling rate from {:g} to {:g} Hz, found {:.4g} "
                            "by the times; give the unit of the times such as --axes \"t=1 ms\"",
                            file_, sensor_, least_rate, most_rate, rate));
        return compared(rate);
    }

private:
    void require_two() const {
        require(rows_.time.size() > 1,
                fmt::format("{}: {}: expected at least two samples with times that advance, found "
                            "{}",
                            file_, sensor_, rows_.time.size()));
    }

    /// A counter that begins again after 255, 65535 or 4294967295 goes on; another one that goes
    /// back is none.
    void unwrap_counter() {
        double turns = 0, before = -1;
        for (double& n : rows_.counter) {
            for (const double turn : {0x1p8, 0x1p16, 0x1p32})
                if (n + turns < before && before - turns < turn && before - turns > 0.9 * turn &&
                    n < 0.1 * turn) {
                    turns += turn;
                    break;
                }
            n += turns;
            if (n <= before) {
                notes_.push_back(fmt::format("{}: the counter goes back from {:g} to {:g}, and is "
                                             "not used.",
                                             sensor_, before, n));
                rows_.counter.clear();
                return;
            }
            before = n;
        }
        if (rows_.counter.size() < 2) return;
        std::vector<double> steps;
        for (std::size_t k = 1; k < rows_.counter.size(); ++k)
            steps.push_back(rows_.counter[k] - rows_.counter[k - 1]);
        const double step = median(std::move(steps)), first = rows_.counter.front();
        for (double& n : rows_.counter) n = first + std::round((n - first) / step);
        const double lost =
            rows_.counter.back() - first + 1 - static_cast<double>(rows_.counter.size());
        if (lost > 0)
            notes_.push_back(
                fmt::format("{}: {:g} samples are missing by the counter.", sensor_, lost));
        for (std::size_t k = 1; k < rows_.counter.size(); ++k)
            if (rows_.counter[k] <= rows_.counter[k - 1]) return rows_.counter.clear();
    }

    double count_times() {
        require(stated_ > least_rate && stated_ < most_rate,
                fmt::format("{}: expected a sampling rate from {:g} to {:g} Hz, found {:g}", file_,
                            least_rate, most_rate, stated_));
        require_two();
        for (std::size_t k = 0; k < rows_.time.size(); ++k)
            rows_.time[k] = (rows_.counter.empty() ? static_cast<double>(k)
                                                   : rows_.counter[k] - rows_.counter[0]) /
                            stated_;
        return stated_;
    }

    void leave_out_backwards() {
        std::vector<char> is_kept(rows_.time.size(), 1);
        std::size_t backwards = 0;
        double last = -HUGE_VAL;
        for (std::size_t k = 0; k < rows_.time.size(); ++k) {
            if (rows_.time[k] < last) {
                is_kept[k] = 0;
                ++backwards;
            } else {
                last = rows_.time[k];
            }
        }
        if (backwards == 0) return;
        require(20 * backwards <= rows_.time.size(),
                fmt::format("{}: {}: expected times that advance, found {} of {} before those of "
                            "earlier rows; cut the file where its clock begins again",
                            file_, sensor_, backwards, rows_.time.size()));
        notes_.push_back(fmt::format("{}: left out: {} of {} rows whose times go back.", sensor_,
                                     backwards, rows_.time.size()));
        keep(rows_, is_kept);
    }

    /// If more than one time in ten repeats, spreads them until the next time. Returns the rate,
    /// Hz; 0: they do not.
    double rate_of_repeated() {
        auto& time = rows_.time;
        std::size_t repeated = 0;
        for (std::size_t k = 1; k < time.size(); ++k)
            repeated += static_cast<std::size_t>(time[k] == time[k - 1]);
        if (10 * repeated <= time.size() || time.size() < 3) return 0;
        // all but those of the last time, which may have been cut
        const auto last =
            static_cast<std::size_t>(std::ranges::lower_bound(time, time.back()) - time.begin());
        require(last > 0, fmt::format("{}: {}: expected times that advance, found {} of {} that "
                                      "repeat",
                                      file_, sensor_, repeated, time.size()));
        const double rate = static_cast<double>(last) / (time.back() - time.front());
        for (std::size_t begin = 0, end = 0; begin < time.size(); begin = end) {
            const double from = time[begin];
            while (end < time.size() && time[end] == from) ++end;
            const auto count = static_cast<double>(end - begin);
            const double step =
                end < time.size() ? std::min((time[end] - from) / count, 1.4 / rate) : 1 / rate;
            for (std::size_t k = begin; k < end; ++k)
                time[k] = from + static_cast<double>(k - begin) * step;
        }
        notes_.push_back(fmt::format("{}: {} of {} times repeat; the samples of each are spread "
                                     "evenly until the next.",
                                     sensor_, repeated, time.size()));
        return rate;
    }

    void leave_out_repeated() {
        std::vector<char> is_kept(rows_.time.size(), 1);
        std::size_t repeated = 0;
        for (std::size_t k = 1; k < rows_.time.size(); ++k)
            if (rows_.time[k] == rows_.time[k - 1]) {
                is_kept[k] = 0;
                ++repeated;
            }
        if (repeated == 0) return;
        notes_.push_back(fmt::format("{}: left out: {} of {} rows whose times repeat those of the "
                                     "row before.",
                                     sensor_, repeated, rows_.time.size()));
        keep(rows_, is_kept);
    }

    double compared(double rate) {
        if (!(stated_ > 0)) return rate;
        if (std::abs(rate / stated_ - 1) <= 0.02) return stated_;
        require(!is_rate_of_user_,
                fmt::format("{}: {}: expected {:g} samples a second (--rate), found {:.5g} by the "
                            "times; leave --rate out, or give the unit of the times with --axes",
                            file_, sensor_, stated_, rate));
        notes_.push_back(fmt::format("{}: {:.5g} samples a second by the times, which are used; "
                                     "the file states {:g} Hz.",
                                     sensor_, rate, stated_));
        return rate;
    }

    LoggedRows& rows_;
    double stated_;
    bool is_timed_, is_rate_of_user_;
    const std::string &file_, &sensor_;
    std::vector<std::string>& notes_;
};

} // namespace

double order_times(LoggedRows& rows, const LoggerColumns& columns, bool is_rate_of_user,
                   const std::string& file, const std::string& sensor,
                   std::vector<std::string>& notes) {
    return Clock(rows, columns, is_rate_of_user, file, sensor, notes).order();
}

} // namespace bris
