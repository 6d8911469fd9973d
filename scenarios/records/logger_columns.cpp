#include "scenarios/records/logger_columns.hpp"

#include "engine/errors.hpp"
#include "scenarios/records/logged_time.hpp"
#include "scenarios/records/logged_units.hpp"
#include "scenarios/records/stated_rate.hpp"
#include "scenarios/sensors/column_titles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

namespace bris {

namespace {

/// Whether a title is one of a counter of samples or lines.
bool is_counter(const std::string& title) {
    static const std::set<std::string> names{
        "line", "csvline", "lineno", "row",      "index",        "idx",   "n",
        "no",   "samples", "sample", "sampleno", "samplenumber", "count", "frame"};
    std::string plain;
    for (const char c : title)
        if (std::isalpha(static_cast<unsigned char>(c)))
            plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return names.contains(plain) || match_title(title, {"seq"}).has_value();
}

class ColumnFinder {
public:
    ColumnFinder(const LoggerTable& table, const LoggerSettings& settings,
                 std::vector<std::string>& notes)
        : table_(table), notes_(notes), sample_(sample_of(table)), is_taken_(table.width, 0),
          given_(given_columns(settings.axes, table)) {
        rows_ = sample_.empty() ? 0 : sample_.front().numbers.size();
        require(rows_ > 1, fmt::format("{}: expected at least two rows of numbers, found {}",
                                       table.path.string(), rows_));
        columns_.rate = settings.rate > 0 ? settings.rate : rate_stated_in(table.above);
    }

    void add_given(const std::vector<GivenColumn>& more) {
        given_.insert(given_.end(), more.begin(), more.end());
    }

    LoggerColumns find() {
        for (const GivenColumn& column : given_) is_taken_[column.index] = 1;
        find_id();
        find_counter();
        find_logged_time(table_, sample_, sensor_, given("t"), columns_, is_taken_, notes_);
        find_axes();
        note_others();
        return std::move(columns_);
    }

private:
    const GivenColumn* given(const char* ours) const {
        const auto found = std::ranges::find(given_, ours, &GivenColumn::ours);
        return found == given_.end() ? nullptr : &*found;
    }

    /// Whether a column may be that of sensors: names, or whole numbers, of which there are few.
    bool may_be_id(std::size_t c) const {
        if (sample_[c].share_of_names >= 0.9)
            return sample_[c].texts <= std::max<std::size_t>(20, rows_ / 4);
        if (sample_[c].share_of_numbers < 0.9) return false;
        std::set<double> different;
        for (const double x : sample_[c].numbers) {
            if (std::isfinite(x) && !is_count(x)) return false;
            if (std::isfinite(x)) different.insert(x);
        }
        return 3 * different.size() <= 2 * rows_;
    }

    void find_id() {
        if (const GivenColumn* const id = given("id")) {
            columns_.id = id->index;
        } else {
            for (std::size_t c = 0; c < table_.width && !columns_.id; ++c) {
                const bool is_called = table_.titles.empty()
                                           ? sample_[c].share_of_names >= 0.9 || is_unnamed_id(c)
                                           : match_title(table_.titles[c], {"id"}).has_value();
                if (!is_taken_[c] && is_called && may_be_id(c)) columns_.id = c;
            }
        }
        sensor_.assign(rows_, 0);
        if (!columns_.id) return;
        is_taken_[*columns_.id] = 1;
        columns_.id_is_name = sample_[*columns_.id].share_of_names >= 0.5;
        if (!columns_.id_is_name)
            sensor_ = sample_[*columns_.id].numbers;
        else
            number_names();
    }

    /// Without titles, a column of numbers is one of sensors if it is the second of five, or of
    /// eight with angular rates, after the times.
    bool is_unnamed_id(std::size_t c) const {
        std::size_t numbers = 0;
        for (const SampledColumn& column : sample_)
            numbers += static_cast<std::size_t>(column.has_numbers());
        const bool after_time = sample_[0].share_of_dates >= 0.5 || sample_[0].has_numbers();
        return c == 1 && after_time && (table_.width == 5 || table_.width == 8) &&
               numbers + 1 >= table_.width && sample_[c].has_numbers();
    }

    /// Numbers the names in the sampled rows, so that times can be compared sensor by sensor.
    void number_names() {
        std::map<std::string, double, std::less<>> numbers;
        std::size_t row = 0;
        table_.each_row([&](std::size_t, const std::vector<std::string_view>& cells) {
            if (cells.size() != table_.width) return true;
            const auto number = static_cast<double>(numbers.size());
            sensor_[row] = numbers.emplace(std::string(cells[*columns_.id]), number).first->second;
            return ++row < rows_;
        });
    }

    /// Without titles, one that grows by one from row to row.
    bool is_unnamed_counter(std::size_t c) const {
        const auto& numbers = sample_[c].numbers;
        for (std::size_t row = 1; row < numbers.size(); ++row)
            if (numbers[row] != numbers[row - 1] + 1) return false;
        return true;
    }

    void find_counter() {
        for (std::size_t c = 0; c < table_.width; ++c) {
            const bool counts =
                !is_taken_[c] && sample_[c].share_of_numbers > 0.9 &&
                (table_.titles.empty() ? is_unnamed_counter(c) : is_counter(table_.titles[c])) &&
                std::ranges::all_of(sample_[c].numbers,
                                    [](double x) { return !std::isfinite(x) || is_count(x); });
            if (!counts || share_that_advances(sample_[c].numbers, sensor_) < 0.9) continue;
            columns_.counter = c;
            is_taken_[c] = 1;
            return;
        }
    }

    /// The sensor whose number a vector has; without numbers, or with one number for all forces
    /// and one for all rates, there is one sensor.
    LoggerAxes& sensor_of(const LoggedVector& vector, bool is_one) {
        auto& all = columns_.sensors;
        auto found =
            is_one ? all.begin() : std::ranges::find(all, vector.number, &LoggerAxes::number);
        if (found == all.end()) found = all.insert(all.end(), {.number = vector.number});
        return *found;
    }

    void find_axes() {
        const auto vectors = find_logged_vectors(table_, sample_, given_, is_taken_, notes_);
        const auto forces = std::ranges::count(vectors, false, &LoggedVector::is_rate),
                   rates = std::ranges::count(vectors, true, &LoggedVector::is_rate);
        for (const LoggedVector& vector : vectors) {
            const ScaledVector scaled_vector = scaled(vector, table_, sample_, sensor_, notes_);
            if (!scaled_vector.is_known) continue;
            LoggerAxes& sensor = sensor_of(vector, forces <= 1 && rates <= 1);
            (vector.is_rate ? sensor.rate : sensor.force) = scaled_vector.axes;
            if (!vector.is_rate) sensor.has_gravity = scaled_vector.has_gravity;
        }
        require(!columns_.sensors.empty(),
                fmt::format("{}: expected accelerations, or angular rates with a unit, found {}",
                            table_.path.string(), table_.columns()));
        require(columns_.sensors.size() == 1 || !columns_.id,
                fmt::format("{}: expected sensors by {}, or by numbers in the names of columns, "
                            "found both in {}; add --axes \"ax=2, ay=3, az=4\"",
                            table_.path.string(), table_.described(columns_.id.value_or(0)),
                            table_.columns()));
    }

    void note_others() {
        constexpr std::size_t most = 12;
        std::vector<std::string> others;
        for (std::size_t c = 0; c < table_.width; ++c)
            if (!is_taken_[c] && (table_.titles.empty() || !table_.titles[c].empty()))
                others.push_back(table_.described(c));
        if (others.empty()) return;
        const std::size_t more = others.size() - std::min(most, others.size());
        others.resize(others.size() - more);
        notes_.push_back(fmt::format("Not used: {}{}.", listed(others),
                                     more > 0 ? fmt::format(" and {} more", more) : ""));
    }

    const LoggerTable& table_;
    std::vector<std::string>& notes_;
    std::vector<SampledColumn> sample_;
    std::vector<char> is_taken_;
    std::vector<GivenColumn> given_;
    std::size_t rows_ = 0;
    std::vector<double> sensor_; // of each row
    LoggerColumns columns_;
};

/// The columns of BRIS, of which a logger's file needs none.
std::vector<KnownColumn> columns_not_needed() {
    std::vector<KnownColumn> all = recording_columns();
    for (KnownColumn& column : all) column.needed = false;
    return all;
}

} // namespace

CsvForm form_of_logger(const std::filesystem::path& map) {
    return read_column_map(map, columns_not_needed());
}

LoggerColumns find_logger_columns(const LoggerTable& table, const LoggerSettings& settings,
                                  std::vector<std::string>& notes) {
    ColumnFinder finder(table, settings, notes);
    if (!settings.columns.empty())
        finder.add_given(given_columns(form_of_logger(settings.columns), table));
    return finder.find();
}

} // namespace bris
