#include "engine/io/csv.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace bris {

namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

void read_header(CsvTable& table, std::string_view line, const std::string& at) {
    for (const std::string_view cell : cells_of(line)) {
        const std::string name(cell);
        if (name.empty() || number_of(cell))
            throw InputError(
                fmt::format("{}: expected column names, found \"{}\"", at, trimmed(line)));
        if (table.has(name))
            throw InputError(fmt::format("{}: column '{}': expected once, found twice", at, name));
        table.names.push_back(name);
    }
}

void read_row(CsvTable& table, std::string_view line, const std::string& at) {
    const auto cells = cells_of(line);
    if (cells.size() != table.names.size())
        throw InputError(fmt::format("{}: expected {} columns ({}), found {}", at,
                                     table.names.size(), listed(table.names), cells.size()));
    std::vector<double> row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto value = number_of(cells[i]);
        if (!value)
            throw InputError(fmt::format("{}: column '{}': expected a number, found \"{}\"", at,
                                         table.names[i], cells[i]));
        row.push_back(*value);
    }
    table.rows.push_back(std::move(row));
}

} // namespace

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t start = 0; start <= line.size();) {
        const std::size_t comma = std::min(line.find(',', start), line.size());
        cells.push_back(trimmed(line.substr(start, comma - start)));
        start = comma + 1;
    }
    return cells;
}

std::optional<double> number_of(std::string_view cell) {
    if (cell.empty() || cell == "-") return std::numeric_limits<double>::quiet_NaN();
    if (cell.front() == '+') cell.remove_prefix(1);
    double value = 0;
    const char* const end = cell.data() + cell.size();
    const auto [stop, error] = std::from_chars(cell.data(), end, value);
    if (error != std::errc{} || stop != end) return {};
    return value;
}

bool CsvTable::has(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<double> CsvTable::column(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw InputError(fmt::format("{}: expected a column '{}', found {}", path.string(), name,
                                     listed(names)));
    std::vector<double> values;
    for (const auto& row : rows)
        values.push_back(row[static_cast<std::size_t>(found - names.begin())]);
    return values;
}

CsvTable read_csv(const std::filesystem::path& path) {
    const std::string content = read_whole(path);
    CsvTable table;
    table.path = path;
    std::string_view rest = content;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3); // byte order mark of spreadsheets
    for (int number = 1; !rest.empty(); ++number) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = trimmed(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (line.empty() || line.front() == '#') continue;
        const std::string at = fmt::format("{}:{}", path.string(), number);
        if (table.names.empty()) {
            read_header(table, line, at);
        } else {
            read_row(table, line, at);
            table.lines.push_back(number);
        }
    }
    if (table.names.empty())
        throw InputError(
            fmt::format("{}:1: expected a line of column names, found none", path.string()));
    return table;
}

void write_csv(const std::filesystem::path& path, const std::vector<std::string>& names,
               const std::vector<std::vector<double>>& rows,
               const std::vector<std::string>& comments, int digits) {
    std::string text;
    for (const std::string& comment : comments) text += "# " + comment + "\n";
    for (std::size_t i = 0; i < names.size(); ++i) text += (i ? "," : "") + names[i];
    text += '\n';
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i) text += ',';
            if (std::isnan(row[i])) continue; // an empty cell, as read
            // shortest text that reads back to the same bits
            text +=
                digits >= 17 ? fmt::format("{}", row[i]) : fmt::format("{:.{}g}", row[i], digits);
        }
        text += '\n';
    }
    write_whole(path, text);
}

} // namespace bris
