#include "engine/io/text_table.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace bris {

namespace {

bool contains_one_of(std::string_view text, std::initializer_list<std::string_view> parts) {
    return std::ranges::any_of(
        parts, [&](std::string_view part) { return text.find(part) != std::string_view::npos; });
}

std::string in_lower_case(std::string_view text) {
    std::string lower(text);
    for (char& letter : lower)
        if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    return lower;
}

/// "sieve size [mm]", "sieve size (mm)" and "sieve_size_mm" have the unit mm.
TextTable::Column column_titled(std::string_view title) {
    constexpr std::array<std::string_view, 20> units{
        "mm", "cm", "m",  "um", "in", "inch", "ft",  "percent", "fraction", "N",
        "kN", "MN", "kg", "g",  "t",  "lb",   "lbf", "kip",     "kips",     "pct"};
    std::string_view name = title, unit;
    if (title.ends_with(']') || title.ends_with(')')) {
        const auto at = title.rfind(title.ends_with(']') ? '[' : '(');
        if (at != std::string_view::npos) {
            unit = trimmed(title.substr(at + 1, title.size() - at - 2));
            name = trimmed(title.substr(0, at));
        }
    } else if (const auto at = title.find_last_of("_ "); at != std::string_view::npos) {
        const std::string_view last = title.substr(at + 1);
        if (last == "%" || std::ranges::find(units, last) != units.end()) {
            unit = last;
            name = title.substr(0, at);
        }
    }
    return {std::string(title), in_lower_case(name), std::string(unit)};
}

/// Whether a cell looks like a number with this decimal separator.
bool has_decimal(std::string_view cell, char separator) {
    const auto at = cell.find(separator);
    return at != std::string_view::npos &&
           cell.find_first_not_of("+-0123456789.,eE") == std::string_view::npos;
}

void find_decimal(TextTable& table) {
    if (table.delimiter == ',') return;
    bool commas = false, points = false;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        for (const std::string& cell : table.rows[row]) {
            commas = commas || has_decimal(cell, ',');
            points = points || has_decimal(cell, '.');
            if (commas && points)
                throw InputError(fmt::format("{}: expected decimal points or decimal commas, found "
                                             "both",
                                             table.where(row)));
        }
    if (commas) table.decimal = ',';
}

} // namespace

bool TextTable::Column::is_named(std::initializer_list<std::string_view> parts) const {
    return contains_one_of(name, parts);
}

std::optional<std::size_t> TextTable::find(std::initializer_list<std::string_view> parts,
                                           std::initializer_list<std::string_view> without) const {
    std::optional<std::size_t> found;
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!columns[k].is_named(parts) || columns[k].is_named(without)) continue;
        require(!found,
                fmt::format("{}: expected one of the columns '{}' and '{}', found both",
                            path.string(), columns[found.value_or(0)].title, columns[k].title));
        found = k;
    }
    return found;
}

std::size_t TextTable::column(std::string_view what, std::initializer_list<std::string_view> parts,
                              std::initializer_list<std::string_view> without) const {
    if (const auto found = find(parts, without)) return *found;
    std::vector<std::string> titles;
    for (const Column& column : columns) titles.push_back(column.title);
    throw InputError(
        fmt::format("{}: expected a column '{}', found {}", path.string(), what, listed(titles)));
}

double TextTable::number(std::size_t row, std::size_t column) const {
    std::string cell = rows[row][column];
    if (decimal == ',') std::ranges::replace(cell, ',', '.');
    if (const auto value = number_of(cell)) return *value;
    throw InputError(fmt::format("{}: column '{}': expected a number, found \"{}\"", where(row),
                                 columns[column].title, rows[row][column]));
}

std::string TextTable::where(std::size_t row) const {
    return fmt::format("{}:{}", path.string(), lines[row]);
}

std::string TextTable::separators() const {
    if (delimiter == ',') return {};
    return fmt::format("{} and decimal {}", delimiter == ';' ? "semicolons" : "tabs",
                       decimal == ',' ? "commas" : "points");
}

TextTable read_text_table(const std::filesystem::path& path) {
    TextTable table{.path = path, .columns = {}, .rows = {}, .lines = {}};
    const std::string content = read_text(path);
    std::string_view remaining = content;
    for (int number = 1; !remaining.empty(); ++number) {
        const std::size_t end = std::min(remaining.find('\n'), remaining.size());
        const std::string_view whole = remaining.substr(0, end), line = trimmed(whole);
        remaining.remove_prefix(std::min(end + 1, remaining.size()));
        if (line.empty() || line.front() == '#') continue;
        if (table.columns.empty()) {
            for (const char delimiter : {',', '\t', ';'})
                if (line.find(delimiter) != std::string_view::npos) table.delimiter = delimiter;
            for (const std::string_view title : cells_of(line, table.delimiter)) {
                if (title.empty() || number_of(title))
                    throw InputError(fmt::format("{}:{}: expected column names, found \"{}\"",
                                                 path.string(), number, line));
                table.columns.push_back(column_titled(title));
            }
            continue;
        }
        // a tab at either end delimits an empty cell
        const auto cells = cells_of(table.delimiter == '\t' ? whole : line, table.delimiter);
        if (cells.size() != table.columns.size())
            throw InputError(fmt::format("{}:{}: expected {} columns, found {}", path.string(),
                                         number, table.columns.size(), cells.size()));
        table.rows.emplace_back(cells.begin(), cells.end());
        table.lines.push_back(number);
    }
    require(!table.columns.empty(),
            fmt::format("{}:1: expected a line of column names, found none", path.string()));
    find_decimal(table);
    return table;
}

} // namespace bris
