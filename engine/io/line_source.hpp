#pragma once

#include "engine/io/arrival.hpp"
#include "engine/stopwatch.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace bris {

/// Lines that arrive one after the other from somewhere.
class Lines {
public:
    struct Line {
        std::uint64_t number; ///< counted from 1
        std::string text;     ///< without the end of line
        Instant arrived;      ///< {}: in an earlier session of a run that was resumed
        /// False: cut off by the end of the input, or longer than `longest`.
        bool whole = true;
        double arrival = no_arrival; ///< s since 1970 UTC (arrival_now); NaN: of a file
    };
    virtual ~Lines() = default;
    /// The next line; waits at most `timeout` (s) for it. Returns nothing if no line arrived, the
    /// input has ended or the user stops the run.
    virtual std::optional<Line> next(double timeout) = 0;
    /// Whether the input has ended and all lines were taken.
    virtual bool over() const = 0;
    /// Time (s since 1970 UTC) by which all that arrived was given; it goes on while nothing
    /// arrives. NaN: nothing arrives here, but is read from a file.
    virtual double now() const = 0;
    /// Whether what comes was given before, in an earlier session of a run that was resumed.
    virtual bool is_repeating() const { return false; }
};

/// Lines as they arrive from the standard input ("-"), a pipe or a growing file. A separate thread
/// reads them, stamps those that do not come from a file with the time of arrival, and queues them.
/// While the queue is full nothing is read, so that the writer of a pipe has to wait; no line is
/// lost.
class LineSource : public Lines {
public:
    /// Longest line in bytes; the rest of a longer line is skipped.
    static constexpr std::size_t longest = 1 << 16;

    /// Opens the source; nothing is read while `capacity` lines or more are in the queue. Throws
    /// OutputError if it cannot be opened.
    explicit LineSource(const std::filesystem::path& path, std::size_t capacity = 100'000);
    ~LineSource() override;

    std::optional<Line> next(double timeout) override;
    /// A growing file never ends.
    bool over() const override;
    double now() const override;

private:
    struct Reader;
    std::unique_ptr<Reader> reader_;
};

} // namespace bris
