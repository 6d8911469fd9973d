#pragma once

#include "engine/stopwatch.hpp"
#include "scenarios/stream/stream_log.hpp"

#include <filesystem>
#include <optional>

namespace bris {

/// Gives the entries of a log at their times.
class LogReplay {
public:
    /// `speed`: relative to the times of arrival; 0: at once. `until`: bytes of the log. Throws
    /// like StreamLogReader.
    LogReplay(const std::filesystem::path& path, double speed,
              std::uint64_t until = std::numeric_limits<std::uint64_t>::max());
    /// The next entry; waits at most `timeout` (s) until it is due. Nothing: none was due, the user
    /// stops the run, or there are no more.
    std::optional<LogEntry> next(double timeout);
    bool over() const { return !coming_; }
    /// Arrival of the latest line, message or tick that was given.
    double now() const { return now_; }
    LoggedRecords records() const { return reader_.records(); }

private:
    StreamLogReader reader_;
    double speed_, first_ = no_arrival, now_ = no_arrival; // s
    std::optional<LogEntry> coming_;
    Instant began_ = this_instant();
};

} // namespace bris
