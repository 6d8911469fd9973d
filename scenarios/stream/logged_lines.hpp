#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/stream/log_replay.hpp"

#include <memory>
#include <optional>

namespace bris {

/// The lines of a log, again. They have the arrival that they had.
class ReplayedLines : public Lines {
public:
    /// `speed`: relative to the times of arrival; 0: at once. `until`: bytes of the log. Throws
    /// like StreamLogReader.
    ReplayedLines(const std::filesystem::path& path, double speed,
                  std::uint64_t until = std::numeric_limits<std::uint64_t>::max())
        : replay_(path, speed, until) {}
    /// Nothing also at a tick.
    std::optional<Line> next(double timeout) override;
    bool over() const override { return replay_.over(); }
    double now() const override { return replay_.now(); }

private:
    LogReplay replay_;
    std::uint64_t lines_ = 0;
};

/// Lines that are logged as they pass, after those of the earlier sessions of the log. What its
/// user sees, lines and the time `now`, is what a replay of the log shows: while nothing arrives,
/// `now` goes on in ticks of a second, which are logged too.
class LoggedLines : public Lines {
public:
    /// Throws like StreamLogReader.
    LoggedLines(std::unique_ptr<Lines> source, std::shared_ptr<StreamLog> log);
    ~LoggedLines() override; ///< logs what has arrived and was not taken
    std::optional<Line> next(double timeout) override;
    bool over() const override { return !earlier_ && source_->over(); }
    double now() const override { return now_; }
    bool is_repeating() const override { return earlier_.has_value(); }

private:
    void log(const Line& line);

    std::unique_ptr<Lines> source_;
    std::shared_ptr<StreamLog> log_;
    std::optional<ReplayedLines> earlier_;
    double now_ = no_arrival;
    std::uint64_t lines_ = 0;
};

/// The lines of a file or pipe, or of a log, at once.
std::unique_ptr<Lines> open_lines(const std::filesystem::path& stream);

} // namespace bris
