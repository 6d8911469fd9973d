#include "scenarios/records/given_columns.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace bris {

namespace {

constexpr std::string_view names = "t, id, ax, ay, az, gx, gy, gz";

bool is_name(std::string_view ours) {
    const auto all = cells_of(names);
    return std::ranges::find(all, ours) != all.end();
}

/// Parts of a text between commas outside quotes and brackets.
std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts(1);
    bool is_quoted = false;
    int open = 0;
    for (const char c : text) {
        if (c == '"') is_quoted = !is_quoted;
        open += (c == '(' || c == '[') - (c == ')' || c == ']');
        if (c == ',' && !is_quoted && open <= 0)
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

/// The column with this number or title; nothing: there is none.
std::optional<std::size_t> column_called(std::string_view word, const LoggerTable& table) {
    word = trimmed(word);
    std::size_t number = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, number);
    if (error == std::errc{} && stop == end && number >= 1 && number <= table.width)
        return number - 1;
    if (word.size() > 1 && word.front() == '"' && word.back() == '"')
        word = word.substr(1, word.size() - 2);
    const auto found = std::ranges::find(table.titles, word);
    if (word.empty() || found == table.titles.end()) return {};
    return static_cast<std::size_t>(found - table.titles.begin());
}

GivenColumn given(const std::string& part, const LoggerTable& table) {
    const auto equals = part.find('=');
    const std::string ours(trimmed(part.substr(0, equals)));
    require(equals != std::string::npos && is_name(ours),
            fmt::format("--axes: expected entries such as \"ax=2\" or \"az=4 g\" with one of {}, "
                        "found \"{}\"",
                        names, trimmed(part)));
    std::string_view value = trimmed(std::string_view(part).substr(equals + 1));
    GivenColumn column{.ours = ours};
    const auto find = [&](std::string_view word) {
        auto index = column_called(word, table);
        if (!index && word.starts_with('-')) {
            index = column_called(word.substr(1), table);
            if (index) column.sign = -1;
        }
        if (index) column.index = *index;
        return index.has_value();
    };
    if (find(value)) return column;
    const auto& units = std::ranges::find(recording_columns(), ours, &KnownColumn::name)->units;
    const auto blank = value.find_last_of(" \t");
    if (blank != std::string_view::npos && find(value.substr(0, blank))) {
        const auto word = trimmed(value.substr(blank));
        column.unit = unit_named(word, units);
        std::vector<std::string> possible;
        for (const ColumnUnit& unit : units) possible.push_back(unit.name);
        require(!column.unit.empty(), fmt::format("--axes: {}: expected a unit, one of {}, found "
                                                  "\"{}\"",
                                                  ours, listed(possible), word));
        return column;
    }
    throw InputError(fmt::format("--axes: {}: expected the number or title of a column of '{}', "
                                 "which has {}, found \"{}\"",
                                 ours, table.path.string(), table.columns(), value));
}

void require_each_once(const std::vector<GivenColumn>& columns) {
    for (std::size_t a = 0; a < columns.size(); ++a)
        for (std::size_t b = a + 1; b < columns.size(); ++b)
            require(columns[a].ours != columns[b].ours && columns[a].index != columns[b].index,
                    fmt::format("--axes: expected each name and each column once, found {} and {} "
                                "for column {}",
                                columns[a].ours, columns[b].ours, columns[b].index + 1));
}

} // namespace

std::vector<GivenColumn> given_columns(const std::string& axes, const LoggerTable& table) {
    std::vector<GivenColumn> columns;
    if (trimmed(axes).empty()) return columns;
    for (const std::string& part : parts_of(axes)) columns.push_back(given(part, table));
    require_each_once(columns);
    return columns;
}

std::vector<GivenColumn> given_columns(const CsvForm& form, const LoggerTable& table) {
    std::vector<GivenColumn> columns;
    for (const CsvColumn& c : form.columns) {
        if (!is_name(c.ours)) continue;
        const auto found = std::ranges::find(table.titles, c.theirs);
        require(found != table.titles.end(),
                fmt::format("{}: expected a column '{}' ({} of {}), found {}", table.path.string(),
                            c.theirs, c.ours, c.where, table.columns()));
        columns.push_back({.ours = c.ours,
                           .index = static_cast<std::size_t>(found - table.titles.begin()),
                           .sign = c.scale < 0 ? -1.0 : 1.0,
                           .unit = c.unit});
    }
    return columns;
}

} // namespace bris
