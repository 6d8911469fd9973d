#include "scenarios/records/guess_columns.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/records/stated_rate.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/column_titles.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>

namespace bris {

namespace {

using Cells = std::vector<std::string>;

/// A column of the file: its name, the unit in the line below the names, and its first numbers.
struct Column {
    std::string title, unit_below = "";
    std::vector<double> numbers = {};
    bool is_taken = false;

    bool has_numbers() const {
        return std::ranges::any_of(numbers, [](double x) { return std::isfinite(x); });
    }
    std::string described() const {
        return fmt::format("\"{}\"{}", title, has_numbers() ? "" : " (no numbers)");
    }
};

/// A column of BRIS that has been recognised.
struct Match {
    const KnownColumn* ours;
    Column* theirs;
    std::string unit_word = ""; ///< as stated; "": not stated
    std::string unit = "";      ///< as column maps spell it; "": not known yet
};

std::string names_of(const std::vector<ColumnUnit>& units) {
    Cells names;
    for (const ColumnUnit& unit : units) names.push_back(unit.name);
    return listed(names);
}

class Guess {
public:
    Guess(const std::filesystem::path& csv, const std::vector<KnownColumn>& known,
          const FileEvidence& evidence)
        : csv_(csv), known_(known), evidence_(evidence) {
        std::istringstream text(read_text(csv));
        for (std::string line; lines_.size() < most_lines && std::getline(text, line);)
            lines_.push_back(line);
    }

    GuessedMap make() {
        find_header();
        for (const Column& column : columns_)
            if (!column.title.empty()) guess_.titles.push_back(column.described());
        for (const KnownColumn& ours : known_) match(ours);
        for (Match& m : matches_) take_stated_unit(m);
        for (const char* name : {"deviatoric_stress_Pa", "axial_strain", "strain"}) find_unit(name);
        for (Match& m : matches_)
            if (m.ours->name != "t") find_unit(m.ours->name.c_str());
        find_unit("t"); // the rate of strain may show it
        check_vectors();
        for (const Match& m : matches_) write(m);
        Cells others;
        for (const Column& column : columns_)
            if (!column.is_taken && !column.title.empty()) others.push_back(column.described());
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
        const std::string_view text =
            delimiter_ == '\t' ? std::string_view(lines_[line]) : trimmed(lines_[line]);
        for (const auto cell : cells_of(text, delimiter_)) all.emplace_back(cell);
        return all;
    }

    /// The first line of numbers below line k if that has their names: the next one or, below a
    /// line of units, the one after it. Dates and other texts may stand among the numbers. 0: none.
    std::size_t numbers_below(std::size_t k) const {
        const auto is_number = [&](const std::string& cell) { return number(cell).has_value(); };
        const auto holds_number = [&](const std::string& cell) {
            return !cell.empty() && is_number(cell);
        };
        const Cells names = cells(k);
        if (names.size() < 2 || std::ranges::any_of(names, holds_number)) return 0;
        for (std::size_t row = k + 1; row < std::min(k + 3, lines_.size()); ++row) {
            const Cells here = cells(row);
            const auto count = static_cast<std::size_t>(std::ranges::count_if(here, is_number));
            if (here.size() == names.size() && count >= 2 && 2 * count >= here.size() &&
                std::ranges::any_of(here, holds_number))
                return row;
        }
        return 0;
    }

    void find_header() {
        constexpr std::array<std::pair<char, const char*>, 4> delimiters{
            {{';', "semicolon"}, {'\t', "tab"}, {',', "comma"}, {' ', "space"}}};
        for (const auto& [delimiter, word] : delimiters)
            for (const char decimal : {'.', ','}) {
                if (delimiter == decimal) continue;
                delimiter_ = delimiter, decimal_ = decimal;
                for (std::size_t k = 0; k < lines_.size(); ++k)
                    if (const std::size_t row = numbers_below(k)) return read_header(k, row, word);
            }
        const std::string first = lines_.empty() ? "" : lines_.front().substr(0, 60);
        throw InputError(fmt::format("{}: expected a line of column names above lines of numbers, "
                                     "separated by commas, semicolons, tabs or blanks, found none "
                                     "in the first {} lines, which begin with \"{}\"; add one",
                                     csv_.string(), lines_.size(), trimmed(first)));
    }

    /// Whether decimals are separated by a comma in the table from this line on, although the first
    /// line has whole numbers only.
    bool has_decimal_commas(std::size_t first) const {
        bool has_commas = false;
        for (std::size_t row = first; row < lines_.size(); ++row)
            for (std::string cell : cells(row)) {
                const bool is_number = number_of(cell).has_value();
                if (is_number && cell.find('.') != std::string::npos) return false;
                std::ranges::replace(cell, ',', '.');
                has_commas = has_commas || (!is_number && number_of(cell).has_value());
            }
        return has_commas;
    }

    void read_header(std::size_t k, std::size_t first, const char* delimiter) {
        if (delimiter_ != ',' && decimal_ == '.' && has_decimal_commas(first)) decimal_ = ',';
        guess_.map =
            fmt::format("delimiter = {}\ndecimal = {}\nheader_line = {}\nfirst_line = {}\n",
                        delimiter, decimal_ == ',' ? "comma" : "point", k + 1, first + 1);
        note(fmt::format("The names of the columns stand in line {}; cells are separated by a {}, "
                         "decimals by a {}.",
                         k + 1, delimiter, decimal_ == ',' ? "comma" : "point"));
        for (const std::string& title : cells(k)) columns_.push_back({title});
        if (const Cells below = cells(k + 1); first == k + 2 && below.size() == columns_.size())
            for (std::size_t c = 0; c < columns_.size(); ++c)
                columns_[c].unit_below = without_brackets(below[c]);
        for (std::size_t row = first; row < lines_.size(); ++row) {
            const Cells numbers = cells(row);
            if (numbers.size() != columns_.size()) continue;
            for (std::size_t c = 0; c < columns_.size(); ++c)
                columns_[c].numbers.push_back(number(numbers[c]).value_or(std::nan("")));
        }
        evidence_.rate = guess_.rate =
            rate_stated_in({lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(k)});
    }

    static std::string without_brackets(const std::string& unit) {
        const bool has = unit.size() > 1 && (unit.front() == '[' || unit.front() == '(');
        return std::string(trimmed(has ? unit.substr(1, unit.size() - 2) : unit));
    }

    void match(const KnownColumn& ours) {
        const auto is_free = [](const Column& c) {
            return !c.is_taken && !c.title.empty() && c.has_numbers();
        };
        auto found = std::ranges::find_if(
            columns_, [&](const Column& c) { return is_free(c) && c.title == ours.name; });
        if (found == columns_.end())
            found = std::ranges::find_if(columns_, [&](const Column& c) {
                return is_free(c) && match_title(c.title, ours).has_value();
            });
        if (found == columns_.end()) return;
        found->is_taken = true;
        const std::string stated = match_title(found->title, ours)->unit_word.value_or("");
        matches_.push_back({&ours, &*found, stated.empty() ? found->unit_below : stated});
        numbers_.of[ours.name] = found->numbers;
        guess_.found.push_back(ours.name);
    }

    void take_stated_unit(Match& m) {
        if (m.ours->units.empty() || m.unit_word.empty()) return;
        const std::string unit = unit_named(m.unit_word, m.ours->units);
        if (!unit.empty()) return take(m, unit);
        ask(m, fmt::format("the unit \"{}\" is not known", m.unit_word));
    }

    void take(Match& m, const std::string& unit) {
        m.unit = unit;
        numbers_.unit[m.ours->name] = *std::ranges::find(m.ours->units, unit, &ColumnUnit::name);
    }

    void ask(Match& m, const std::string& why) {
        m.unit = "?";
        guess_.open.push_back(fmt::format("{} (\"{}\"): {}", m.ours->name, m.theirs->title, why));
    }

    /// The unit of a column that states none, by other sources.
    void find_unit(const char* name) {
        const auto m = std::ranges::find_if(
            matches_, [&](const Match& other) { return other.ours->name == name; });
        if (m == matches_.end() || m->ours->units.empty() || !m->unit.empty()) return;
        const PossibleUnits possible = possible_units(*m->ours, numbers_, evidence_);
        if (possible.units.size() != 1) return ask(*m, "no unit is stated");
        take(*m, possible.units.front().name);
        note(fmt::format("The unit of \"{}\" is not stated; {} is assumed, because {}: check it.",
                         m->theirs->title, m->unit, possible.reason));
    }

    /// A vector with components in different units, or without some of them, is none.
    void check_vectors() {
        for (const Channel& channel : all_channels) {
            Cells there, missing;
            for (std::size_t k = 0; k < channel.size(); ++k) {
                const std::string column(channel.column(k));
                (std::ranges::count(guess_.found, column) > 0 ? there : missing).push_back(column);
            }
            if (there.empty() || missing.empty()) continue;
            throw InputError(fmt::format(
                "{}: expected all components of a vector, found {} without {}, in the columns {}; "
                "add the others or rename these",
                csv_.string(), listed(there), listed(missing), listed(guess_.titles)));
        }
    }

    void write(const Match& m) {
        guess_.map += fmt::format("{} = \"{}\"{}{}\n", m.ours->name, m.theirs->title,
                                  m.unit.empty() ? "" : ", ", m.unit);
        if (m.unit == "?") guess_.map += fmt::format("#   one of {}\n", names_of(m.ours->units));
        note(fmt::format("{} is \"{}\"{}.", m.ours->name, m.theirs->title,
                         m.unit.empty()  ? ""
                         : m.unit == "?" ? ", whose unit has to be given"
                                         : " in " + m.unit));
    }

    static constexpr std::size_t most_lines = 2000; // that a guess is made from
    std::filesystem::path csv_;
    const std::vector<KnownColumn>& known_;
    FileEvidence evidence_;
    Cells lines_;
    char delimiter_ = ',', decimal_ = '.';
    std::vector<Column> columns_;
    std::vector<Match> matches_;
    FileNumbers numbers_;
    GuessedMap guess_;
};

} // namespace

GuessedMap guess_columns(const std::filesystem::path& csv, const std::vector<KnownColumn>& known,
                         FileEvidence evidence) {
    return Guess(csv, known, evidence).make();
}

void write_guessed_map(const std::filesystem::path& csv, const GuessedMap& guess,
                       const std::filesystem::path& map) {
    write_whole(map, fmt::format("# Guessed from {}: check names, units and signs.\n{}",
                                 csv.filename().string(), guess.map));
    require(guess.open.empty(),
            fmt::format("{}: expected a unit for each column, found none for {}; give them in {} "
                        "in place of \"?\"",
                        csv.string(), listed(guess.open), map.string()));
}

} // namespace bris
