#include "scenarios/stream/record_stream.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/json_numbers.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace bris {

namespace {

[[noreturn]] void refuse(const LineSource::Line& line, const std::string& why) {
    throw InputError(fmt::format("line {}: {}", line.number, why));
}

} // namespace

double StreamRecord::number(const std::string& name) const {
    const auto found = numbers.find(name);
    return found == numbers.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

std::optional<StreamRecord> RecordParser::parse(const LineSource::Line& line) {
    const std::string_view text = without_mark(line.text); // the first line may have one
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || text[first] == '#') return {};
    if (!line.whole)
        refuse(line, fmt::format("expected a whole line, found a truncated one: \"{}\"",
                                 beginning_of(line.text)));
    StreamRecord record{line.number, line.arrived, line.arrival, {}};
    if (text[first] == '{') {
        try {
            record.numbers = json_numbers(line.text); // skips a mark
        } catch (const InputError& e) {
            refuse(line, e.what());
        }
        return record;
    }
    const auto cells = cells_of(text);
    const auto named = [&](const char* name) { return std::ranges::count(cells, name) == 1; };
    if (named("t") || named("axial_strain")) {
        columns_.assign(cells.begin(), cells.end());
        return {};
    }
    parse_row(line, record);
    return record;
}

void RecordParser::parse_row(const LineSource::Line& line, StreamRecord& record) const {
    if (columns_.empty())
        refuse(line, fmt::format("expected a JSON object or the names of columns, found \"{}\"",
                                 beginning_of(line.text)));
    const auto cells = cells_of(line.text);
    if (cells.size() != columns_.size())
        refuse(line, fmt::format("expected {} columns, found {}", columns_.size(), cells.size()));
    for (std::size_t k = 0; k < cells.size(); ++k) {
        if (cells[k].empty() || cells[k] == "-") continue;
        const auto number = number_of(cells[k]);
        if (!number)
            refuse(line, fmt::format("{}: expected a number, found \"{}\"", columns_[k], cells[k]));
        record.numbers.emplace(columns_[k], *number);
    }
}

} // namespace bris
