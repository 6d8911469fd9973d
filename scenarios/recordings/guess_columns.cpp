#include "scenarios/recordings/guess_columns.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"
#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

namespace bris {

namespace {

using Cells = std::vector<std::string>;

/// A column of the file: its name without the unit, in lower case and without punctuation, its unit
/// in the spelling of column maps, and its first numbers.
struct Column {
    std::string title, name, unit;
    std::vector<double> numbers;
};

/// Ways in which the columns of other programs are called, in the form of Column::name. For a
/// vector the axis precedes or follows.
const std::map<std::string, Cells>& aliases() {
    static const std::map<std::string, Cells> all{
        {"t", {"t", "time", "timestamp", "seconds", "elapsedtime", "sampletime", "zeit"}},
        {"id",
         {"id", "sensor", "sensorid", "node", "nodeid", "device", "deviceid", "rock", "rockid",
          "nr", "address"}},
        {"seq",
         {"seq", "sequence", "sequencenumber", "counter", "samplecounter", "packet",
          "packetcounter"}},
        {"flags", {"flags", "flag", "status", "error"}},
        {"strain", {"strain", "axialstrain"}},
        {"phase", {"phase", "cycle", "cycles", "loadcycle"}},
        {"temp", {"temp", "temperature"}},
        {"batt", {"batt", "battery", "vbat", "batteryvoltage", "batterylevel"}},
        {"a",
         {"a", "acc", "accel", "acceleration", "accelerometer", "linacc", "force",
          "specificforce"}},
        {"g",
         {"g", "gyr", "gyro", "gyroscope", "w", "omega", "rate", "angrate", "angularrate",
          "angularvelocity", "rotationrate"}},
        {"m", {"m", "mag", "magn", "magnetometer", "magneticfield", "field"}},
        {"u", {"u", "disp", "displacement"}},
        {"q", {"q", "quat", "quaternion"}},
        {"axial_strain", {"axialstrain", "strain", "epsa", "epsilona", "ea"}},
        {"deviatoric_stress_Pa",
         {"q", "deviatoricstress", "deviatorstress", "devstress", "deviatoricstresspa"}},
        {"volumetric_strain", {"volumetricstrain", "volstrain", "epsv", "epsilonv", "ev"}}};
    return all;
}

std::string plain(std::string_view text) {
    std::string letters;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)))
            letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

/// A unit as column maps spell it.
std::string spelled(std::string unit, const std::vector<ColumnUnit>& units) {
    static const std::map<std::string, std::string> others{
        {"m/s^2", "m/s2"}, {"m/s\u00b2", "m/s2"}, {"ms-2", "m/s2"},
        {"m/s/s", "m/s2"}, {"dps", "deg/s"},      {"\u00b0/s", "deg/s"},
        {"degc", "C"},     {"\u00b0C", "C"},      {"\u00b5T", "uT"},
        {"\u03bcT", "uT"}, {"\u00b5s", "us"},     {"sec", "s"},
        {"msec", "ms"},    {"percent", "%"},      {"gauss", "G"},
        {"kpa", "kPa"},    {"volt", "V"},         {"-", "1"}};
    if (const auto other = others.find(unit); other != others.end()) unit = other->second;
    for (const ColumnUnit& known : units)
        if (plain(known.name + "x") == plain(unit + "x") &&
            (known.name.size() == unit.size() && known.name.back() == unit.back()))
            return known.name;
    return {};
}

/// Separates "Gyro X [deg/s]", "Time (ms)" and "acc_x_mg" into name and unit.
Column column_titled(const std::string& title) {
    Column column{.title = title, .name = {}, .unit = {}, .numbers = {}};
    const auto open = title.find_last_of("[("), close = title.find_last_of("])");
    std::string name = title;
    if (open != std::string::npos && close != std::string::npos && close > open) {
        column.unit = std::string(trimmed(title.substr(open + 1, close - open - 1)));
        name = title.substr(0, open);
    } else if (const auto mark = title.rfind('_'); mark != std::string::npos) {
        const std::string last = title.substr(mark + 1);
        constexpr std::array units{"ms", "us", "mg", "dps", "s", "mT", "uT", "mm", "kPa", "C"};
        if (std::ranges::count(units, last) > 0) {
            column.unit = last;
            name = title.substr(0, mark);
        }
    }
    column.name = plain(name);
    return column;
}

/// Whether a column is called like this one of BRIS.
bool is_called(const std::string& name, const std::string& ours) {
    const bool is_vector =
        ours.size() == 2 && std::string("agmuq").find(ours[0]) != std::string::npos;
    const auto found = aliases().find(is_vector ? ours.substr(0, 1) : ours);
    if (found == aliases().end()) return name == plain(ours);
    if (!is_vector) return std::ranges::count(found->second, name) > 0;
    const std::string axis = ours.substr(1);
    Cells axes{axis};
    if (ours[0] == 'q') axes.push_back(std::string(1, "0123"[std::string("wxyz").find(axis)]));
    return std::ranges::any_of(found->second, [&](const std::string& alias) {
        return std::ranges::any_of(axes, [&](const std::string& a) {
            return name == alias + a || name == alias + "axis" + a || name == a + alias ||
                   name == a + "axis" + alias;
        });
    });
}

class Guess {
public:
    Guess(const std::filesystem::path& csv, const std::vector<KnownColumn>& known)
        : csv_(csv), known_(known) {
        std::istringstream text(read_text(csv));
        for (std::string line; lines_.size() < most_lines && std::getline(text, line);)
            lines_.push_back(line);
    }

    GuessedMap make() {
        find_header();
        for (const KnownColumn& ours : known_) assign(ours);
        Cells others;
        for (const Column& column : columns_)
            if (!column.title.empty()) others.push_back("\"" + column.title + "\"");
        if (!others.empty()) note(fmt::format("Not recognised and ignored: {}.", listed(others)));
        return std::move(guess_);
    }

private:
    void note(const std::string& text) { guess_.notes.push_back(printable(text)); }

    std::optional<double> number(std::string cell) const {
        if (decimal_ == ',') std::ranges::replace(cell, ',', '.');
        return number_of(cell);
    }

    Cells cells(std::size_t line) const {
        Cells all;
        for (const auto cell : cells_of(trimmed(lines_[line]), delimiter_)) all.emplace_back(cell);
        return all;
    }

    /// The first line of numbers below line k if that has their names: the next one or, below a
    /// line of units, the one after it. Dates and other texts may stand among the numbers. 0: none.
    std::size_t numbers_below(std::size_t k) const {
        const auto is_number = [&](const std::string& cell) { return number(cell).has_value(); };
        const Cells names = cells(k);
        if (names.size() < 2 || std::ranges::any_of(names, is_number)) return 0;
        for (std::size_t row = k + 1; row < std::min(k + 3, lines_.size()); ++row) {
            const Cells here = cells(row);
            const auto count = static_cast<std::size_t>(std::ranges::count_if(here, is_number));
            if (here.size() == names.size() && count >= 2 && 2 * count >= here.size()) return row;
        }
        return 0;
    }

    void find_header() {
        constexpr std::array<std::pair<char, const char*>, 3> delimiters{
            {{';', "semicolon"}, {'\t', "tab"}, {',', "comma"}}};
        for (const auto& [delimiter, word] : delimiters)
            for (const char decimal : {'.', ','}) {
                if (delimiter == decimal) continue;
                delimiter_ = delimiter, decimal_ = decimal;
                for (std::size_t k = 0; k < lines_.size(); ++k)
                    if (const std::size_t row = numbers_below(k)) return read_header(k, row, word);
            }
        throw InputError(fmt::format("{}: expected a line of column names above lines of numbers, "
                                     "separated by commas, semicolons or tabs, found none in the "
                                     "first {} lines",
                                     csv_.string(), lines_.size()));
    }

    void read_header(std::size_t k, std::size_t first, const char* delimiter) {
        guess_.map =
            fmt::format("delimiter = {}\ndecimal = {}\nheader_line = {}\nfirst_line = {}\n",
                        delimiter, decimal_ == ',' ? "comma" : "point", k + 1, first + 1);
        note(fmt::format("The names of the columns stand in line {}; cells are separated by a {}, "
                         "decimals by a {}.",
                         k + 1, delimiter, decimal_ == ',' ? "comma" : "point"));
        for (const std::string& title : cells(k)) columns_.push_back(column_titled(title));
        for (std::size_t row = first; row < lines_.size(); ++row) {
            const Cells numbers = cells(row);
            for (std::size_t c = 0; c < columns_.size() && c < numbers.size(); ++c)
                columns_[c].numbers.push_back(number(numbers[c]).value_or(std::nan("")));
        }
    }

    void assign(const KnownColumn& ours) {
        auto found = std::ranges::find(columns_, ours.name, &Column::title);
        if (found == columns_.end())
            found = std::ranges::find_if(columns_, [&](const Column& column) {
                return !column.title.empty() && is_called(column.name, ours.name);
            });
        if (found == columns_.end()) return;
        std::string unit;
        if (!ours.units.empty()) {
            unit = spelled(found->unit, ours.units);
            if (unit.empty()) unit = unit_by_size(ours, *found);
        }
        guess_.map += fmt::format("{} = \"{}\"{}{}\n", ours.name, found->title,
                                  unit.empty() ? "" : ", ", unit);
        note(fmt::format("{} is \"{}\"{}.", ours.name, found->title,
                         unit.empty() ? "" : " in " + unit));
        guess_.found.push_back(ours.name);
        *found = {};
    }

    /// The unit that the numbers suggest where the name has none, or one that is not known.
    std::string unit_by_size(const KnownColumn& ours, const Column& column) {
        std::string unit = ours.units.front().name, reason = "the usual unit";
        std::vector<double> sizes;
        for (const double x : column.numbers)
            if (std::isfinite(x)) sizes.push_back(std::abs(x));
        const auto intervals = ours.name == "t" ? intervals_of(column) : std::vector<double>{};
        if (!intervals.empty()) {
            // clocks that count have whole numbers
            const double interval = median(intervals);
            const bool counts =
                std::ranges::all_of(sizes, [](double t) { return t == std::floor(t); });
            unit = !counts || interval <= 1 ? "s" : interval > 500 ? "us" : "ms";
            reason = fmt::format("because of {} with intervals of {:.3g}",
                                 counts ? "whole numbers" : "decimals", interval);
        } else if (ours.name.size() == 2 && ours.name[0] == 'a') {
            const double most = largest_axis();
            unit = most > 100 ? "mg" : most > 4 ? "m/s2" : "g";
            reason = fmt::format("because of values of up to {:.3g} along an axis", most);
        } else if (ours.name.ends_with("strain") && !sizes.empty() &&
                   std::ranges::max(sizes) > 0.5) {
            unit = "%";
            reason = "because of its size";
        }
        note(fmt::format("The unit of \"{}\" is {}; {} is assumed, {}: check it.", column.title,
                         column.unit.empty() ? "not stated" : "not known (" + column.unit + ")",
                         unit, reason));
        return unit;
    }

    /// Positive intervals between the times of each sensor.
    std::vector<double> intervals_of(const Column& times) const {
        const auto ids = std::ranges::find_if(columns_, [](const Column& column) {
            return !column.title.empty() && is_called(column.name, "id");
        });
        std::map<double, double> last; // by sensor
        std::vector<double> intervals;
        for (std::size_t k = 0; k < times.numbers.size(); ++k) {
            const bool known = ids != columns_.end() && k < ids->numbers.size();
            const double id = known ? ids->numbers[k] : 0, t = times.numbers[k];
            if (!std::isfinite(t) || !std::isfinite(id)) continue;
            const auto [before, is_first] = last.try_emplace(id, t);
            if (!is_first && t > before->second) intervals.push_back(t - before->second);
            before->second = t;
        }
        return intervals;
    }

    /// The largest median of the three accelerations: at rest that of gravity, or near it.
    double largest_axis() {
        if (largest_axis_ > 0) return largest_axis_;
        for (const Column& column : columns_)
            for (const char* name : {"ax", "ay", "az"}) {
                if (column.title.empty() || !is_called(column.name, name)) continue;
                std::vector<double> sizes;
                for (const double x : column.numbers)
                    if (std::isfinite(x)) sizes.push_back(std::abs(x));
                if (!sizes.empty()) largest_axis_ = std::max(largest_axis_, median(sizes));
            }
        return largest_axis_;
    }

    static constexpr std::size_t most_lines = 2000; // that a guess is made from
    std::filesystem::path csv_;
    const std::vector<KnownColumn>& known_;
    std::vector<std::string> lines_;
    char delimiter_ = ',', decimal_ = '.';
    std::vector<Column> columns_;
    double largest_axis_ = 0;
    GuessedMap guess_;
};

} // namespace

GuessedMap guess_columns(const std::filesystem::path& csv, const std::vector<KnownColumn>& known) {
    return Guess(csv, known).make();
}

} // namespace bris
