#include "engine/io/column_map.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>
#include <utility>

namespace bris {

namespace {

/// Position of the first occurrence of a character outside quotes; npos: none.
std::size_t outside_quotes(const std::string& text, char sign) {
    bool quoted = false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] == '"') quoted = !quoted;
        if (text[k] == sign && !quoted) return k;
    }
    return std::string::npos;
}

std::string unquoted(const std::string& text) {
    return text.size() > 1 && text.front() == '"' && text.back() == '"'
               ? text.substr(1, text.size() - 2)
               : text;
}

std::string names_of(const auto& items, auto name) {
    std::vector<std::string> names;
    for (const auto& item : items) names.push_back(item.*name);
    return listed(names);
}

class ColumnMap {
public:
    ColumnMap(const std::filesystem::path& path, const std::vector<KnownColumn>& known)
        : path_(path), known_(known) {}

    CsvForm read() {
        std::istringstream in(read_text(path_));
        std::string line;
        for (unsigned number = 1; std::getline(in, line); ++number) {
            where_ = fmt::format("{}:{}", path_.string(), number);
            const std::string content(trimmed(line.substr(0, outside_quotes(line, '#'))));
            if (!content.empty()) read_line(content, number);
        }
        for (const KnownColumn& column : known_)
            if (column.needed && form_.find(column.name) == nullptr)
                throw InputError(fmt::format("{}: expected a line for '{}', found none",
                                             path_.string(), column.name));
        if (form_.delimiter == form_.decimal)
            throw InputError(fmt::format(
                "{}: expected a delimiter different from the decimal sign, found comma for both",
                path_.string()));
        for (const auto& [what, sign] :
             {std::pair{"delimiter", form_.delimiter}, std::pair{"decimal sign", form_.decimal}})
            if (sign == form_.comment)
                throw InputError(fmt::format(
                    "{}: expected a comment sign different from the {}, found '{}' for both",
                    path_.string(), what, sign));
        if (const unsigned names = std::max(form_.header_line, 1u);
            form_.first_line != 0 && form_.first_line <= names)
            throw InputError(fmt::format(
                "{}: first_line: expected a line after the column names in line {}, found {}",
                path_.string(), names, form_.first_line));
        return std::move(form_);
    }

private:
    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw InputError(fmt::format("{}: expected {}, found \"{}\"", where_, expected, found));
    }

    void read_line(const std::string& content, unsigned number) {
        const auto equals = content.find('=');
        if (equals == std::string::npos) refuse("a line `our name = their name, unit`", content);
        const std::string name(trimmed(content.substr(0, equals))),
            value(trimmed(content.substr(equals + 1)));
        if (value.empty()) refuse(fmt::format("a value for '{}'", name), "");
        if (const auto [earlier, first] = seen_.emplace(name, number); !first)
            throw InputError(fmt::format("{}: {}: expected once, found on line {} already", where_,
                                         name, earlier->second));
        const auto column = std::ranges::find(known_, name, &KnownColumn::name);
        if (column != known_.end())
            read_column(*column, value);
        else if (name == "delimiter")
            form_.delimiter =
                one_of(value, {{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"space", ' '}});
        else if (name == "decimal")
            form_.decimal = one_of(value, {{"point", '.'}, {"comma", ','}});
        else if (name == "comment")
            form_.comment = one_sign(value);
        else if (name == "header_line")
            form_.header_line = line_number(value);
        else if (name == "first_line")
            form_.first_line = line_number(value);
        else
            refuse(fmt::format("one of delimiter, decimal, comment, header_line, first_line, {}",
                               names_of(known_, &KnownColumn::name)),
                   name);
    }

    char one_of(const std::string& value,
                const std::vector<std::pair<std::string, char>>& choices) const {
        const auto found =
            std::ranges::find(choices, unquoted(value), &std::pair<std::string, char>::first);
        if (found != choices.end()) return found->second;
        refuse("one of " + names_of(choices, &std::pair<std::string, char>::first), value);
    }

    char one_sign(const std::string& value) const {
        if (unquoted(value).size() != 1) refuse("a single character", value);
        return unquoted(value).front();
    }

    unsigned line_number(const std::string& value) const {
        unsigned line = 0;
        const char* const end = value.data() + value.size();
        const auto [stop, error] = std::from_chars(value.data(), end, line);
        if (error != std::errc{} || stop != end || line == 0)
            refuse("a line number, counted from 1", value);
        return line;
    }

    void read_column(const KnownColumn& known, const std::string& value) {
        const auto comma = outside_quotes(value, ',');
        std::string theirs(trimmed(value.substr(0, comma)));
        const std::string unit(
            comma == std::string::npos ? "" : trimmed(std::string_view(value).substr(comma + 1)));
        const bool turned = theirs.starts_with('-');
        if (turned) theirs = std::string(trimmed(theirs.substr(1)));
        CsvColumn column{
            .ours = known.name, .theirs = unquoted(theirs), .unit = unit, .where = where_};
        if (column.theirs.empty()) refuse("a column name", value);
        if (comma != std::string::npos) {
            const auto given = std::ranges::find(known.units, unit, &ColumnUnit::name);
            if (given == known.units.end() && known.units.empty())
                refuse("no unit for " + known.name, unit);
            if (given == known.units.end())
                refuse(fmt::format("a unit of {}, one of {}", known.name,
                                   names_of(known.units, &ColumnUnit::name)),
                       unit);
            column.scale = given->scale;
            column.offset = given->offset;
        }
        if (turned) column.scale = -column.scale;
        const auto taken = std::ranges::find(form_.columns, column.theirs, &CsvColumn::theirs);
        if (taken != form_.columns.end())
            throw InputError(
                fmt::format("{}: column '{}': expected under one name, found under {} and {}",
                            where_, column.theirs, taken->ours, known.name));
        form_.columns.push_back(std::move(column));
    }

    std::filesystem::path path_;
    const std::vector<KnownColumn>& known_;
    CsvForm form_;
    std::string where_;
    std::map<std::string, unsigned> seen_; // names and their line numbers
};

} // namespace

CsvForm read_column_map(const std::filesystem::path& path, const std::vector<KnownColumn>& known) {
    return ColumnMap(path, known).read();
}

std::filesystem::path map_to_use(const std::filesystem::path& given,
                                 const std::filesystem::path& own) {
    return given.empty() && std::filesystem::exists(own) ? own : given;
}

std::vector<std::string> titles_of(const std::vector<KnownColumn>& known, const CsvForm& form) {
    std::vector<std::string> titles;
    for (const CsvColumn& column : form.columns) titles.push_back(column.theirs);
    if (form.columns.empty())
        for (const KnownColumn& column : known) titles.push_back(column.name);
    return titles;
}

} // namespace bris
