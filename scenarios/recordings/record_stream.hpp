#pragma once

#include "engine/io/line_source.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// What a SmartRock or a test machine sends at one time: numbers by their names, those of
/// recordings (t, id, seq, strain, ax ...) and of tests (axial_strain, deviatoric_stress_Pa ...). A
/// number that was not sent is not among them.
struct StreamRecord {
    std::uint64_t line;
    Instant arrived;
    std::map<std::string, double> numbers;

    bool has(const std::string& name) const { return numbers.contains(name); }
    /// NaN: not sent.
    double number(const std::string& name) const;
};

/// Makes records of lines: each an object of JSON with numbers, or a row of CSV after a line with
/// the names of its columns; both may come in one stream, and another header changes the columns.
/// JSON null, an empty cell and "-" are not sent.
class RecordParser {
public:
    /// Nothing: an empty line, a comment ("#") or a header. Throws InputError with the line's
    /// number, what was expected and what was found.
    std::optional<StreamRecord> parse(const LineSource::Line& line);

private:
    void parse_row(const LineSource::Line& line, StreamRecord& record) const;
    std::vector<std::string> columns_;
};

} // namespace bris
