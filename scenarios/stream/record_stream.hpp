#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/sensors/channels.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Names of the numbers that records of a stream may have: those of SmartRocks, with the columns of
/// recordings, and those of a test machine, with the columns of tests.
inline constexpr auto stream_fields = [] {
    constexpr std::string_view
        first = "t id",
        last = "end axial_strain deviatoric_stress_Pa volumetric_strain "
               "ring_1_radius_m ring_2_radius_m ring_3_radius_m ring_4_radius_m ring_5_radius_m "
               "ring_6_radius_m ring_7_radius_m ring_8_radius_m ring_9_radius_m ring_10_radius_m "
               "ring_11_radius_m ring_12_radius_m ring_13_radius_m ring_14_radius_m "
               "ring_15_radius_m ring_16_radius_m ring_17_radius_m ring_18_radius_m "
               "ring_19_radius_m ring_20_radius_m ring_21_radius_m ring_22_radius_m "
               "ring_23_radius_m ring_24_radius_m ring_25_radius_m ring_26_radius_m "
               "ring_27_radius_m ring_28_radius_m ring_29_radius_m ring_30_radius_m "
               "ring_31_radius_m ring_32_radius_m";
    std::array<std::string_view, words_in(first) + channel_columns.size() + words_in(last)> all;
    auto next = all.begin();
    for (std::size_t k = 0; k < words_in(first); ++k) *next++ = word_of(first, k);
    next = std::ranges::copy(channel_columns, next).out;
    for (std::size_t k = 0; k < words_in(last); ++k) *next++ = word_of(last, k);
    return all;
}();
/// The field of the first of channel_columns, which follow in their order.
inline constexpr std::size_t first_channel_field = 2;
static_assert(stream_fields[first_channel_field] == channel_columns.front());
static_assert(stream_fields.size() <= 64, "a record has one bit for each");

/// Record that a SmartRock or a test machine sends at one time: those of the stream_fields that
/// were sent. Takes 56 bytes and 8 for each number.
class StreamRecord {
public:
    StreamRecord(std::uint64_t number_of_line, Instant instant, double time)
        : line(number_of_line), arrived(instant), arrival(time) {}

    std::uint64_t line; ///< number of the line in the stream
    Instant arrived;
    double arrival; ///< s since 1970 UTC; NaN: it did not arrive, but was read from a file

    bool has(std::size_t field) const { return (sent_ >> field & 1) != 0; }
    bool has(std::string_view name) const;
    /// The number of a field or of its name; NaN: not sent.
    double number(std::size_t field) const;
    double number(std::string_view name) const;
    /// Adds a number by the index of its field. Returns false if there is one already.
    bool add(std::size_t field, double number);
    /// All numbers, in the order of the fields.
    std::vector<std::pair<std::string_view, double>> numbers() const;
    const std::vector<double>& values() const { return numbers_; } ///< without their names
    void reserve(std::size_t numbers) { numbers_.reserve(numbers); }

private:
    std::uint64_t sent_ = 0;      // a bit for each field
    std::vector<double> numbers_; // of the bits, in their order
};

/// Parses the lines of a stream into records. A line is a JSON object, or a CSV row after a header
/// line with the names of the columns. Both may occur in one stream, and a new header changes the
/// columns. JSON null, an empty cell and "-" mean that a number was not sent. Fields that nobody
/// uses are ignored, whatever they hold, and named once; a wrong value in a used one refuses the
/// record.
class RecordParser {
public:
    /// `used`: names of stream_fields; none: all of them.
    explicit RecordParser(const std::vector<std::string_view>& used = {});
    /// Returns nothing for an empty line, a comment ("#") or a header. Throws InputError with the
    /// number of the line, the key or column, what was expected and what was found.
    std::optional<StreamRecord> parse(const LineSource::Line& line);
    /// One line that names the fields that were ignored; empty: none were.
    std::string ignored() const;

private:
    std::size_t used_field(std::string_view name);
    void parse_object(const LineSource::Line& line, StreamRecord& record);
    bool is_header(const std::vector<std::string_view>& cells) const;
    void read_header(const LineSource::Line& line, const std::vector<std::string_view>& cells);
    void parse_row(const LineSource::Line& line, const std::vector<std::string_view>& cells,
                   StreamRecord& record) const;

    std::uint64_t used_;
    std::vector<std::size_t> columns_; // their fields
    std::set<std::string, std::less<>> ignored_;
    bool ignores_more_ = false;
};

} // namespace bris
