#include "scenarios/records/logger_table.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/records/date_text.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <tuple>

namespace bris {

namespace {

using Cells = std::vector<std::string_view>;

constexpr std::size_t most_lines = 1000; ///< that the form is found from

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// The line, if it is a comment without its sign; otherwise nothing.
std::optional<std::string_view> commented(std::string_view line) {
    for (const std::string_view sign : {"#", "//", "%"})
        if (line.starts_with(sign)) return trimmed(line.substr(sign.size()));
    return {};
}

/// Cells of a line; a tab at either end delimits an empty one.
Cells split(std::string_view line, char delimiter) {
    return cells_of(delimiter == '\t' ? line : trimmed(line), delimiter);
}

std::string without_brackets(std::string_view unit) {
    const bool has = unit.size() > 1 && (unit.front() == '[' || unit.front() == '(');
    return std::string(trimmed(has ? unit.substr(1, unit.size() - 2) : unit));
}

/// The first lines of a text with their numbers.
std::vector<std::string_view> first_lines(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty() && lines.size() < most_lines) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(line);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

class TableFinder {
public:
    explicit TableFinder(LoggerTable& table) : table_(table), lines_(first_lines(table.text)) {}

    /// By delimiter and decimal sign that make the most of the lines; ties go to the first.
    void find() {
        constexpr std::array<std::pair<char, char>, 7> forms{
            {{';', '.'}, {';', ','}, {'\t', '.'}, {'\t', ','}, {',', '.'}, {' ', '.'}, {' ', ','}}};
        double best = 0;
        std::pair<char, char> of_best;
        for (const auto& form : forms) {
            std::tie(table_.delimiter, table_.decimal) = form;
            if (const double score = score_of_form(); score > best) best = score, of_best = form;
        }
        const std::string_view first = lines_.empty() ? "" : trimmed(lines_.front()).substr(0, 60);
        require(best > 0, fmt::format("{}: expected lines of numbers separated by commas, "
                                      "semicolons, tabs or blanks, found none in the first {} "
                                      "lines, which begin with \"{}\"",
                                      table_.path.string(), lines_.size(), first));
        std::tie(table_.delimiter, table_.decimal) = of_best;
        (void)score_of_form(); // and the width
        find_names();
    }

    /// With the form of a column map.
    void take(const CsvForm& form) {
        table_.delimiter = form.delimiter;
        table_.decimal = form.decimal;
        std::size_t names = form.header_line;
        for (std::size_t k = 0; names == 0 && k < lines_.size(); ++k)
            if (const auto line = trimmed(lines_[k]); !line.empty() && line[0] != form.comment)
                names = k + 1;
        require(names > 0 && names <= lines_.size(),
                fmt::format("{}: expected column names in line {}, found {} lines",
                            table_.path.string(), names, lines_.size()));
        table_.width = split(lines_[names - 1], form.delimiter).size();
        take_names(names - 1, lines_[names - 1]);
        table_.first_line = form.first_line > 0 ? form.first_line : names + 1;
    }

private:
    /// 0 to 1 for what a cell of a row of numbers may be, and whether it is a number.
    std::pair<double, bool> value_of(std::string_view cell) const {
        if (cell.empty()) return {1, false};
        if (const auto number = table_.number(cell)) return {1, std::isfinite(*number)};
        if (date_in(cell)) return {1, false};
        const bool is_name = cell.size() <= 24 && std::ranges::any_of(cell, is_letter) &&
                             std::ranges::none_of(cell, [](char c) { return c == ' '; });
        return {is_name ? 0.5 : 0, false};
    }

    /// How far a line is a row of numbers, 0 to 1; 0: it is none.
    double score_of(const Cells& cells) const {
        double sum = 0;
        bool has_number = false;
        for (const std::string_view cell : cells) {
            const auto [value, is_number] = value_of(cell);
            sum += value;
            has_number = has_number || is_number;
        }
        const double share = sum / static_cast<double>(cells.size());
        return has_number && share >= 0.6 ? share : 0;
    }

    /// Sum of the scores of the lines with the most frequent width, which it keeps.
    double score_of_form() {
        std::map<std::size_t, std::pair<std::size_t, double>> by_width; // lines and scores
        for (const std::string_view line : lines_) {
            const auto content = trimmed(line);
            if (content.empty() || commented(content)) continue;
            const Cells cells = split(line, table_.delimiter);
            if (const double score = score_of(cells); score > 0) {
                auto& [count, sum] = by_width[cells.size()];
                ++count, sum += score;
            }
        }
        const auto best =
            std::ranges::max_element(by_width, {}, [](const auto& w) { return w.second.first; });
        if (best == by_width.end()) return 0;
        table_.width = best->first;
        return best->second.second * (best->first > 1 ? 1 : 0.3); // any line is one cell
    }

    /// The cells of a line that may be one of names or units: none is a number, and there are as
    /// many as in the rows, but for empty ones at the end.
    std::optional<Cells> texts_in(std::string_view line) const {
        const auto content = commented(trimmed(line));
        Cells cells = split(content ? *content : line, table_.delimiter);
        while (cells.size() > table_.width && cells.back().empty()) cells.pop_back();
        if (cells.size() + 1 == table_.width) cells.emplace_back();
        const bool is_text = std::ranges::none_of(cells, [&](std::string_view cell) {
            return !cell.empty() && table_.number(cell).has_value();
        });
        const bool has_letter = std::ranges::any_of(
            cells, [](std::string_view cell) { return std::ranges::any_of(cell, is_letter); });
        if (cells.size() != table_.width || !is_text || !has_letter) return {};
        return cells;
    }

    static bool are_units(const Cells& cells) {
        return std::ranges::all_of(cells, [](std::string_view cell) {
            return cell.empty() || cell == "-" || cell.front() == '[' || cell.front() == '(' ||
                   is_unit(cell);
        });
    }

    void take_names(std::size_t k, std::string_view line) {
        table_.names_line = k + 1;
        const auto content = commented(trimmed(line));
        for (const auto cell : split(content ? *content : line, table_.delimiter))
            table_.titles.emplace_back(cell);
        table_.titles.resize(table_.width);
        for (std::size_t above = 0; above < k; ++above) table_.above.emplace_back(lines_[above]);
    }

    void find_names() {
        std::size_t first = 0;
        for (; first < lines_.size(); ++first) {
            const auto content = trimmed(lines_[first]);
            if (content.empty() || commented(content)) continue;
            const Cells cells = split(lines_[first], table_.delimiter);
            if (cells.size() == table_.width && score_of(cells) > 0) break;
        }
        table_.first_line = first + 1;
        std::vector<std::size_t> above; // the two lines above that are not empty, from below
        for (std::size_t k = first; k > 0 && above.size() < 2; --k)
            if (!trimmed(lines_[k - 1]).empty()) above.push_back(k - 1);
        const auto nearest = above.empty() ? std::nullopt : texts_in(lines_[above[0]]);
        const auto next = above.size() < 2 ? std::nullopt : texts_in(lines_[above[1]]);
        if (nearest && next && are_units(*nearest) && !are_units(*next)) {
            take_names(above[1], lines_[above[1]]);
            for (const std::string_view unit : *nearest)
                table_.units_below.push_back(without_brackets(unit));
        } else if (nearest) {
            take_names(above[0], lines_[above[0]]);
        } else {
            for (std::size_t k = 0; k < first; ++k) table_.above.emplace_back(lines_[k]);
        }
    }

    LoggerTable& table_;
    std::vector<std::string_view> lines_;
};

} // namespace

void LoggerTable::each_row(const std::function<bool(std::size_t, const Cells&)>& take) const {
    std::string_view rest = text;
    for (std::size_t number = 1; !rest.empty(); ++number) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (number < first_line) continue;
        if (line.ends_with('\r')) line.remove_suffix(1);
        const auto content = trimmed(line);
        if (content.empty() || commented(content)) continue;
        if (!take(number, split(line, delimiter))) return;
    }
}

std::optional<double> LoggerTable::number(std::string_view cell) const {
    if (decimal == '.') return number_of(cell);
    if (cell.find('.') != std::string_view::npos || cell.ends_with(',')) return {};
    std::string text_with_point(cell);
    std::ranges::replace(text_with_point, ',', '.');
    return number_of(text_with_point);
}

std::string LoggerTable::described(std::size_t column) const {
    const bool has_title = column < titles.size() && !titles[column].empty();
    return has_title ? fmt::format("\"{}\" (column {})", titles[column], column + 1)
                     : fmt::format("column {}", column + 1);
}

std::string LoggerTable::columns() const {
    constexpr std::size_t most = 30;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < std::min(width, most); ++k)
        names.push_back(titles.empty() ? std::to_string(k + 1) : fmt::format("\"{}\"", titles[k]));
    if (width > most) names.emplace_back("...");
    return titles.empty() ? fmt::format("{} columns without names", width)
                          : fmt::format("the columns {}", listed(names));
}

LoggerTable find_logger_table(const std::filesystem::path& path, const CsvForm* form) {
    LoggerTable table;
    table.path = path;
    table.text = read_text(path);
    TableFinder finder(table);
    if (form != nullptr)
        finder.take(*form);
    else
        finder.find();
    return table;
}

} // namespace bris
