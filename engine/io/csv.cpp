#include "engine/io/csv.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bris {

namespace {

/// Reads the header and the rows of a file in a given format.
class Reader {
public:
    Reader(CsvTable& table, const CsvForm& form) : table_(table), form_(form) {}

    void read_header(std::string_view line, const std::string& at) {
        const auto cells = cells_of(line, form_.delimiter);
        width_ = cells.size();
        table_.titles.assign(cells.begin(), cells.end());
        header_ = listed(table_.titles);
        std::map<std::string_view, std::vector<std::size_t>> indices; // of the cells by their text
        for (std::size_t k = 0; k < width_; ++k) indices[table_.titles[k]].push_back(k);
        const auto add = [&](const std::string& ours, const std::vector<std::size_t>& with_name) {
            const std::string& title = table_.titles[with_name.front()];
            if (with_name.size() > 1)
                table_.unusable.emplace(
                    ours, fmt::format("{}: column '{}': expected once, found twice", at, title));
            table_.names.push_back(ours);
            from_.push_back(with_name.front());
        };
        if (form_.columns.empty()) {
            require_names(line, at);
            for (std::size_t k = 0; k < width_; ++k)
                if (const auto& all = indices[table_.titles[k]];
                    !table_.titles[k].empty() && all.front() == k)
                    add(table_.titles[k], all);
        }
        for (const CsvColumn& column : form_.columns) {
            const auto found = indices.find(column.theirs);
            if (found == indices.end())
                throw InputError(fmt::format("{}: expected a column '{}' ({} of {}), found {}", at,
                                             column.theirs, column.ours, column.where, header_));
            add(column.ours, found->second);
        }
    }

    void read_row(std::string_view line, const std::string& at) {
        const auto cells = cells_of(line, form_.delimiter);
        if (cells.size() != width_)
            throw InputError(fmt::format("{}: expected {} columns ({}), found {}", at, width_,
                                         header_, cells.size()));
        std::vector<double> row;
        for (std::size_t i = 0; i < from_.size(); ++i) {
            const auto value = number_in(cells[from_[i]]);
            const CsvColumn* const wanted = form_.columns.empty() ? nullptr : &form_.columns[i];
            if (!value)
                table_.unusable.try_emplace(
                    table_.names[i], fmt::format("{}: column '{}': expected a number, found \"{}\"",
                                                 at, table_.titles[from_[i]], cells[from_[i]]));
            const double number = value.value_or(std::numeric_limits<double>::quiet_NaN());
            row.push_back(wanted ? wanted->scale * number + wanted->offset : number);
        }
        table_.rows.push_back(std::move(row));
    }

private:
    void require_names(std::string_view line, const std::string& at) const {
        const auto is_name = [](const std::string& title) {
            return !title.empty() && !number_of(title);
        };
        if (std::ranges::none_of(table_.titles, is_name))
            throw InputError(
                fmt::format("{}: expected column names, found \"{}\"", at, trimmed(line)));
    }

    std::optional<double> number_in(std::string_view cell) const {
        if (form_.decimal == '.') return number_of(cell);
        // a thousands separator, or a number in a different format
        if (cell.find('.') != std::string_view::npos) return {};
        std::string text(cell);
        std::replace(text.begin(), text.end(), form_.decimal, '.');
        return number_of(text);
    }

    CsvTable& table_;
    const CsvForm& form_;
    std::vector<std::size_t> from_; // index of the cell of each column
    std::size_t width_ = 0;
    std::string header_;
};

} // namespace

const CsvColumn* CsvForm::find(const std::string& ours) const {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&](const CsvColumn& column) { return column.ours == ours; });
    return found == columns.end() ? nullptr : &*found;
}

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

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
    std::vector<std::string_view> cells;
    cells.reserve(16);
    const bool blanks = delimiter == ' ';
    if (blanks) line = trimmed(line);
    for (std::size_t start = 0; start <= line.size();) {
        const auto begin =
            std::min(line.find_first_not_of(delimiter == '\t' ? " " : " \t", start), line.size());
        const auto quote = begin < line.size() && line[begin] == '"' ? line.find('"', begin + 1)
                                                                     : std::string_view::npos;
        const std::size_t from = quote == std::string_view::npos ? start : quote;
        const std::size_t end = std::min(
            blanks ? line.find_first_of(" \t", from) : line.find(delimiter, from), line.size());
        std::string_view cell = trimmed(line.substr(start, end - start));
        if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"')
            cell = trimmed(cell.substr(1, cell.size() - 2));
        cells.push_back(cell);
        start = blanks && end < line.size() ? line.find_first_not_of(" \t", end) : end + 1;
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
    if (const auto problem = unusable.find(name); problem != unusable.end())
        throw InputError(problem->second);
    std::vector<double> values;
    for (const auto& row : rows)
        values.push_back(row[static_cast<std::size_t>(found - names.begin())]);
    return values;
}

std::vector<std::string> CsvTable::others(const std::vector<std::string>& used) const {
    std::set<std::string> unused(titles.begin(), titles.end());
    unused.erase("");
    for (const std::string& title : used) unused.erase(title);
    return {unused.begin(), unused.end()};
}

CsvTable read_csv(const std::filesystem::path& path, const CsvForm& form) {
    const std::string content = read_text(path);
    CsvTable table;
    table.path = path;
    Reader reader(table, form);
    std::string_view remaining = content;
    for (unsigned number = 1; !remaining.empty(); ++number) {
        const std::size_t end = std::min(remaining.find('\n'), remaining.size());
        const std::string_view whole = remaining.substr(0, end), line = trimmed(whole);
        remaining.remove_prefix(std::min(end + 1, remaining.size()));
        const bool named = !table.names.empty();
        // a given header line is one whatever character it begins with
        const bool is_header = !named && number == form.header_line;
        if (line.empty() || (line.front() == form.comment && !is_header) ||
            number < (named ? form.first_line : form.header_line))
            continue;
        const std::string at = fmt::format("{}:{}", path.string(), number);
        // a tab at either end delimits an empty cell
        const std::string_view cells = form.delimiter == '\t' ? whole : line;
        if (!named) {
            reader.read_header(cells, at);
        } else {
            reader.read_row(cells, at);
            table.lines.push_back(static_cast<int>(number));
        }
    }
    if (form.first_line > 0 && table.lines.empty())
        throw InputError(fmt::format("{}: expected numbers from line {} on (first_line), found "
                                     "none",
                                     path.string(), form.first_line));
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
            if (std::isnan(row[i])) continue; // NaN is an empty cell, as in read_csv
            // the shortest text that reads back to the same bits
            text +=
                digits >= 17 ? fmt::format("{}", row[i]) : fmt::format("{:.{}g}", row[i], digits);
        }
        text += '\n';
    }
    write_whole(path, text);
}

} // namespace bris
