#include "scenarios/stream/record_stream.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/json_members.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t no_field = stream_fields.size();
constexpr std::size_t most_ignored = 20, longest_name = 100; // of fields that are listed
constexpr std::uint64_t bit(std::size_t field) { return std::uint64_t{1} << field; }

/// The fields in the order of their names, to look them up.
constexpr auto by_name = [] {
    std::array<std::pair<std::string_view, std::size_t>, stream_fields.size()> sorted;
    for (std::size_t k = 0; k < sorted.size(); ++k) sorted[k] = {stream_fields[k], k};
    std::ranges::sort(sorted);
    return sorted;
}();

std::size_t field_of(std::string_view name) {
    const auto found =
        std::ranges::lower_bound(by_name, name, {}, &decltype(by_name)::value_type::first);
    return found != by_name.end() && found->first == name ? found->second : no_field;
}

/// Number of the fields before this one that are sent.
std::ptrdiff_t place_of(std::uint64_t sent, std::size_t field) {
    return std::popcount(sent & (bit(field) - 1));
}

[[noreturn]] void refuse(const LineSource::Line& line, const std::string& why) {
    throw InputError(fmt::format("line {}: {}", line.number, why));
}

std::string not_a_number(std::size_t field, std::string_view found) {
    return fmt::format("{}: expected a number, found \"{}\"", stream_fields[field],
                       beginning_of(found));
}

std::string found_twice(std::size_t field) {
    return fmt::format("{}: expected once, found twice", stream_fields[field]);
}

} // namespace

bool StreamRecord::has(std::string_view name) const {
    const std::size_t field = field_of(name);
    return field != no_field && has(field);
}

double StreamRecord::number(std::size_t field) const {
    return has(field) ? numbers_[static_cast<std::size_t>(place_of(sent_, field))]
                      : std::numeric_limits<double>::quiet_NaN();
}

double StreamRecord::number(std::string_view name) const {
    const std::size_t field = field_of(name);
    return field == no_field ? std::numeric_limits<double>::quiet_NaN() : number(field);
}

bool StreamRecord::add(std::size_t field, double number) {
    if ((sent_ & bit(field)) != 0) return false;
    numbers_.insert(numbers_.begin() + place_of(sent_, field), number);
    sent_ |= bit(field);
    return true;
}

std::vector<std::pair<std::string_view, double>> StreamRecord::numbers() const {
    std::vector<std::pair<std::string_view, double>> all;
    for (std::size_t field = 0; field < stream_fields.size(); ++field)
        if ((sent_ & bit(field)) != 0) all.emplace_back(stream_fields[field], numbers_[all.size()]);
    return all;
}

RecordParser::RecordParser(const std::vector<std::string_view>& used)
    : used_(used.empty() ? ~std::uint64_t{0} : 0) {
    for (const std::string_view name : used) used_ |= bit(field_of(name));
}

/// The field of this name, if it is used; others are noted.
std::size_t RecordParser::used_field(std::string_view name) {
    const std::size_t field = field_of(name);
    if (field != no_field && (used_ & bit(field)) != 0) return field;
    if (name.empty() || ignored_.contains(name)) return no_field; // such as an index of rows
    if (ignored_.size() < most_ignored && name.size() <= longest_name)
        ignored_.emplace(name);
    else
        ignores_more_ = true;
    return no_field;
}

std::string RecordParser::ignored() const {
    if (ignored_.empty() && !ignores_more_) return {};
    return fmt::format("fields that nobody uses are ignored: {}{}\n",
                       printable(listed({ignored_.begin(), ignored_.end()})),
                       ignores_more_ ? " and others" : "");
}

std::optional<StreamRecord> RecordParser::parse(const LineSource::Line& line) {
    const std::string_view text = without_mark(line.text); // the first line may have one
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || text[first] == '#') return {};
    if (!line.whole)
        refuse(line, fmt::format("expected a whole line, found a truncated one: \"{}\"",
                                 beginning_of(line.text)));
    StreamRecord record{line.number, line.arrived, line.arrival};
    if (text[first] == '{') {
        parse_object(line, record);
        return record;
    }
    const auto cells = cells_of(text);
    if (is_header(cells)) {
        read_header(line, cells);
        return {};
    }
    parse_row(line, cells, record);
    return record;
}

void RecordParser::parse_object(const LineSource::Line& line, StreamRecord& record) {
    JsonMembers members(without_mark(line.text));
    const auto next = [&] {
        try {
            return members.next();
        } catch (const InputError& e) {
            refuse(line, e.what());
        }
    };
    while (const auto member = next()) {
        const std::size_t field = used_field(member->name);
        if (field == no_field || member->value == "null") continue;
        const auto number = json_number(member->value);
        if (!number) refuse(line, not_a_number(field, member->value));
        if (!record.add(field, *number)) refuse(line, found_twice(field));
    }
}

/// Whether the cells are names of columns. A text in a row may be such a name, too.
bool RecordParser::is_header(const std::vector<std::string_view>& cells) const {
    const auto named = [&](std::string_view name) { return std::ranges::count(cells, name) > 0; };
    if (!named("t") && !named("axial_strain")) return false;
    if (cells.size() != columns_.size()) return true;
    for (std::size_t k = 0; k < cells.size(); ++k)
        if (columns_[k] != no_field && !cells[k].empty() && number_of(cells[k])) return false;
    return true;
}

void RecordParser::read_header(const LineSource::Line& line,
                               const std::vector<std::string_view>& cells) {
    columns_.clear();
    for (const std::string_view cell : cells) {
        const std::size_t field = used_field(cell);
        if (field != no_field && std::ranges::count(columns_, field) > 0) {
            columns_.clear();
            refuse(line, found_twice(field));
        }
        columns_.push_back(field);
    }
}

void RecordParser::parse_row(const LineSource::Line& line,
                             const std::vector<std::string_view>& cells,
                             StreamRecord& record) const {
    if (columns_.empty())
        refuse(line, fmt::format("expected a JSON object or the names of columns, found \"{}\"",
                                 beginning_of(line.text)));
    if (cells.size() != columns_.size())
        refuse(line, fmt::format("expected {} columns, found {}", columns_.size(), cells.size()));
    record.reserve(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
        if (columns_[k] == no_field || cells[k].empty() || cells[k] == "-") continue;
        const auto number = number_of(cells[k]);
        if (!number) refuse(line, not_a_number(columns_[k], cells[k]));
        (void)record.add(columns_[k], *number);
    }
}

} // namespace bris
