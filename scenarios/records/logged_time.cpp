#include "scenarios/records/logged_time.hpp"

#include "engine/errors.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/records/unit_evidence.hpp"
#include "scenarios/sensors/column_titles.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

namespace bris {

namespace {

const KnownColumn& column_of_times() {
    return *std::ranges::find(recording_columns(), "t", &KnownColumn::name);
}

/// Seconds since 1970 of a time of our days.
bool is_of_our_days(double t) { return t > 946684800 && t < 4102444800; }

struct Candidate {
    std::size_t index;
    LoggedTime form;
    double advance; ///< share of its steps
    bool is_absolute;
    std::string word{}; ///< of the unit; "": not stated
};

class TimeFinder {
public:
    TimeFinder(const LoggerTable& table, const std::vector<SampledColumn>& sample,
               const std::vector<double>& sensor, LoggerColumns& columns,
               std::vector<char>& is_taken, std::vector<std::string>& notes)
        : table_(table), sample_(sample), sensor_(sensor), columns_(columns), is_taken_(is_taken),
          notes_(notes) {}

    void find(const GivenColumn* given) {
        if (given != nullptr) {
            add(given->index, given->unit);
            require(!candidates_.empty(),
                    fmt::format("{}: t: expected numbers or dates in {}, found others",
                                table_.path.string(), table_.described(given->index)));
        } else {
            for (std::size_t c = 0; c < sample_.size(); ++c)
                if (!is_taken_[c]) consider(c);
        }
        if (candidates_.empty()) return;
        // a clock of whole seconds advances less often than the samples
        const auto rank = [](const Candidate& c) {
            return std::pair(std::round(10 * c.advance), c.is_absolute);
        };
        const Candidate best = *std::ranges::max_element(candidates_, {}, rank);
        columns_.form = best.form;
        columns_.time.index = best.index;
        columns_.is_absolute = best.is_absolute;
        is_taken_[best.index] = 1;
        if (best.form == LoggedTime::number)
            take_unit(best);
        else if (best.form == LoggedTime::time_of_day)
            find_day();
    }

private:
    void consider(std::size_t c) {
        const bool is_date = sample_[c].share_of_dates >= 0.5 || sample_[c].share_of_times >= 0.5;
        if (is_date) return add(c, "");
        if (!sample_[c].has_numbers()) return;
        if (!table_.titles.empty()) {
            const auto match = match_title(table_.titles[c], column_of_times());
            if (match || may_be_time(table_.titles[c]))
                add(c, match ? match->unit_word.value_or("") : unit_in(table_.titles[c]));
        } else if (share_that_advances(sample_[c].numbers, sensor_) > 0.9) {
            add(c, "");
        }
    }

    /// Titles that are no usual names of times, but hold one: "Time (-)", "epoch (ms)",
    /// "Shimmer_AB_Timestamp_Unix_CAL".
    static bool may_be_time(std::string title) {
        for (char& c : title) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return title.starts_with("time (-)") || title.starts_with("epoc") ||
               title.starts_with("elapsed") || title.find("timestamp") != std::string::npos;
    }

    /// The unit in the brackets of a title; "": none.
    static std::string unit_in(const std::string& title) {
        const auto open = title.find_last_of("(["), close = title.find_last_of(")]");
        if (open == std::string::npos || close == std::string::npos || close < open) return {};
        return unit_named(title.substr(open + 1, close - open - 1), column_of_times().units);
    }

    void add(std::size_t c, std::string word) {
        const SampledColumn& column = sample_[c];
        if (word.empty() && c < table_.units_below.size()) word = table_.units_below[c];
        if (column.share_of_dates >= 0.5)
            candidates_.push_back(
                {c, LoggedTime::date, share_that_advances(column.dates, sensor_), true});
        else if (column.share_of_times >= 0.5)
            candidates_.push_back(
                {c, LoggedTime::time_of_day, share_that_advances(column.dates, sensor_), false});
        else if (column.has_numbers())
            candidates_.push_back({c, LoggedTime::number,
                                   share_that_advances(column.numbers, sensor_),
                                   is_date_in_some_unit(first_of(c), word), word});
    }

    double first_of(std::size_t c) const {
        for (const double x : sample_[c].numbers)
            if (std::isfinite(x)) return x;
        return 0;
    }

    static bool is_date_in_some_unit(double first, const std::string& word) {
        const std::string stated = unit_named(word, column_of_times().units);
        return std::ranges::any_of(column_of_times().units, [&](const ColumnUnit& u) {
            return u.scale <= 1 && (stated.empty() || stated == u.name) &&
                   is_of_our_days(u.scale * first);
        });
    }

    void take_unit(const Candidate& of) {
        const auto& units = column_of_times().units;
        ColumnUnit unit;
        if (!of.word.empty()) {
            const std::string name = unit_named(of.word, units);
            require(!name.empty(),
                    fmt::format("{}: {}: the unit \"{}\" is not known; give it with --axes "
                                "\"t={} ms\"",
                                table_.path.string(), table_.described(of.index), of.word,
                                of.index + 1));
            unit = *std::ranges::find(units, name, &ColumnUnit::name);
        } else {
            unit = assumed_unit(of.index);
        }
        columns_.time.scale = unit.scale;
        columns_.is_absolute = is_of_our_days(unit.scale * first_of(of.index));
    }

    /// The units with which the times may be those of a logger, and why.
    std::pair<std::vector<ColumnUnit>, std::string> possible_units_of(std::size_t c) const {
        FileNumbers numbers;
        numbers.of["t"] = sample_[c].numbers;
        numbers.of["id"] = sensor_;
        const auto intervals = intervals_of(numbers);
        const double interval = intervals.empty() ? 0 : median(intervals);
        std::vector<ColumnUnit> possible, dated;
        for (const ColumnUnit& unit : column_of_times().units) {
            const double rate = 1 / (unit.scale * interval);
            const bool is_near =
                !(columns_.rate > 0) || (rate > 0.2 * columns_.rate && rate < 5 * columns_.rate);
            if (unit.scale > 1 || !is_near || !(rate > 1.0 / 120 && rate < 50e3)) continue;
            possible.push_back(unit);
            if (is_of_our_days(unit.scale * first_of(c)) && rate > 0.5) dated.push_back(unit);
        }
        if (dated.size() == 1) return {dated, "only then are they dates of our days"};
        return {possible, fmt::format("intervals of {:.6g} are then {:.6g} Hz{}", interval,
                                      possible.empty() ? 0 : 1 / (possible[0].scale * interval),
                                      columns_.rate > 0 ? ", as stated" : "")};
    }

    ColumnUnit assumed_unit(std::size_t c) {
        const auto [possible, reason] = possible_units_of(c);
        if (possible.size() != 1)
            throw InputError(fmt::format(
                "{}: expected a unit of the times in {}, found none that is stated, and {} "
                "possible; add --rate HZ, or the unit such as --axes \"t={} ms\"",
                table_.path.string(), table_.described(c),
                !possible.empty()   ? std::string("several that are")
                : columns_.rate > 0 ? fmt::format("none with which {:g} Hz are", columns_.rate)
                                    : "none that is",
                c + 1));
        notes_.push_back(fmt::format("The unit of the times in {} is not stated; {} is assumed, "
                                     "because {}.",
                                     table_.described(c), possible.front().name, reason));
        return possible.front();
    }

    void find_day() {
        for (std::size_t c = 0; c < sample_.size(); ++c)
            if (!is_taken_[c] && sample_[c].share_of_days >= 0.5) {
                columns_.form = LoggedTime::day_and_time;
                columns_.day = c;
                columns_.is_absolute = true;
                is_taken_[c] = 1;
                return;
            }
    }

    const LoggerTable& table_;
    const std::vector<SampledColumn>& sample_;
    const std::vector<double>& sensor_;
    LoggerColumns& columns_;
    std::vector<char>& is_taken_;
    std::vector<std::string>& notes_;
    std::vector<Candidate> candidates_;
};

} // namespace

void find_logged_time(const LoggerTable& table, const std::vector<SampledColumn>& sample,
                      const std::vector<double>& sensor, const GivenColumn* given,
                      LoggerColumns& columns, std::vector<char>& is_taken,
                      std::vector<std::string>& notes) {
    TimeFinder(table, sample, sensor, columns, is_taken, notes).find(given);
}

} // namespace bris
