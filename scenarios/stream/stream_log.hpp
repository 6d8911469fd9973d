#pragma once

#include "engine/io/arrival.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace bris {

/// One line of a log.
struct LogEntry {
    enum class Kind {
        session,   ///< a program began to log
        line,      ///< of a pipe or a file
        message,   ///< from a broker
        published, ///< message to a broker
        tick       ///< nothing arrived until then
    };
    Kind kind = Kind::tick;
    double arrival = no_arrival; ///< s since 1970 UTC; of what is published: when
    std::string topic = {};      ///< of a message
    std::string text = {};       ///< line or payload
    bool whole = true;           ///< of a line, as Lines::Line
    bool retained = false;       ///< of a message
    double anchor = no_arrival;  ///< s, arrival_anchor of a session
    std::string boot = {};       ///< boot_of_computer of a session
};

/// Where the records of a session came from.
enum class LoggedRecords { lines, messages };

/// Writes what arrives, as it arrives, so that the same can be given again: a text file with one
/// JSON object in each line. A session begins with
///     {"format": "bris stream log 1", "records": "lines", "arrival": A, "anchor": B, "boot": C}
/// (or "messages"; B: arrival_anchor, C: boot_of_computer), and goes on with
///     {"arrival": A, "line": "..."}                    and "cut": 1 if the line lacks its end
///     {"arrival": A, "topic": "...", "payload": "..."} and "retained": 1, "published": 1
///     {"arrival": A, "tick": 1}
/// A line of a file has no arrival. What is no text of UTF-8 stands as line_base64,
/// payload_base64. Numbers read back to the same bits. Every entry is written when it is added.
class StreamLog {
public:
    /// Begins a session in a new log, or in one that is there, of which a last line without an end
    /// is dropped. `most_bytes`: of the file; what is beyond is left out and counted. Throws
    /// OutputError, and InputError if the file is something else.
    StreamLog(std::filesystem::path path, LoggedRecords records, std::uint64_t most_bytes);
    ~StreamLog();
    StreamLog(const StreamLog&) = delete;

    /// s for which what has arrived is still logged when a program ends.
    static constexpr double farewell = 1;
    /// Whether nothing arrived for so long that the log says so: from `before`, the time that it
    /// has reached (NaN: none yet), to `now` (NaN: nothing ever arrives).
    static bool is_tick_due(double before, double now) {
        return !(now < before + 1) && !std::isnan(now);
    }

    /// Throws OutputError. After `close` nothing is written any more.
    void add(const LogEntry& entry);
    void close();
    const std::filesystem::path& path() const { return path_; }
    std::uint64_t earlier_bytes() const { return earlier_; } ///< of earlier sessions
    double began() const { return began_; }                  ///< arrival of the session
    std::uint64_t left_out() const { return left_out_; }     ///< entries

private:
    void write(const std::string& text);

    std::filesystem::path path_;
    std::FILE* file_ = nullptr;
    double began_;
    std::uint64_t most_, earlier_ = 0, bytes_ = 0, left_out_ = 0;
};

/// Reads a log, also while it is written. Its last line is left out if it has no end.
class StreamLogReader {
public:
    static constexpr std::size_t longest = 1 << 20; ///< bytes of a line

    /// `until`: bytes. Throws OutputError if the file cannot be read, InputError if it is no log.
    explicit StreamLogReader(const std::filesystem::path& path,
                             std::uint64_t until = std::numeric_limits<std::uint64_t>::max());
    LoggedRecords records() const { return records_; } ///< of the first session
    /// The next entry; nothing: there are no more. Throws InputError: file:line, what was expected
    /// and what was found.
    std::optional<LogEntry> next();

private:
    LogEntry parse(std::string_view line);
    [[noreturn]] void refuse(const std::string& why) const;

    std::filesystem::path path_;
    std::ifstream in_;
    std::string line_;
    std::uint64_t until_, place_ = 0, number_ = 0;
    LoggedRecords records_ = LoggedRecords::lines;
    std::optional<LogEntry> first_;
};

/// Where the arrivals of a log ended. Throws like StreamLogReader.
ArrivalsBefore arrivals_in(const std::filesystem::path& log);

/// Where the records of a log come from; nothing: the file is no log, or not there. Throws
/// InputError for an HDF5 file: histories in run files, as earlier versions had them, are not read
/// any more.
std::optional<LoggedRecords> records_of_log(const std::filesystem::path& path);

} // namespace bris
