#pragma once

#include "engine/io/line_source.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Record that a SmartRock or a test machine sends at one time: numbers by the column names of
/// recordings (t, id, seq, strain, ax ...) and of tests (axial_strain, deviatoric_stress_Pa ...).
/// Numbers that were not sent are absent.
struct StreamRecord {
    std::uint64_t line; ///< number of the line in the stream
    Instant arrived;
    double arrival; ///< s since 1970 UTC; NaN: it did not arrive, but was read from a file
    std::map<std::string, double> numbers;

    bool has(const std::string& name) const { return numbers.contains(name); }
    /// The number of this name; NaN: not sent.
    double number(const std::string& name) const;
};

/// Parses the lines of a stream into records. A line is a JSON object of numbers, or a CSV row
/// after a header line with the names of the columns. Both may occur in one stream, and a new
/// header changes the columns. JSON null, an empty cell and "-" mean that a number was not sent.
class RecordParser {
public:
    /// Returns nothing for an empty line, a comment ("#") or a header. Throws InputError with the
    /// number of the line, what was expected and what was found.
    std::optional<StreamRecord> parse(const LineSource::Line& line);

private:
    void parse_row(const LineSource::Line& line, StreamRecord& record) const;
    std::vector<std::string> columns_;
};

} // namespace bris
