#include "scenarios/stream/logged_lines.hpp"

#include "engine/errors.hpp"
#include "engine/message.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

std::optional<Lines::Line> ReplayedLines::next(double timeout) {
    const Instant called = this_instant();
    while (auto entry = replay_.next(std::max(0.0, timeout - seconds_since(called)))) {
        if (entry->kind == LogEntry::Kind::tick) return {};
        if (entry->kind == LogEntry::Kind::line)
            return Line{++lines_, std::move(entry->text), this_instant(), entry->whole,
                        entry->arrival};
    }
    return {};
}

LoggedLines::LoggedLines(std::unique_ptr<Lines> source, std::shared_ptr<StreamLog> log)
    : source_(std::move(source)), log_(std::move(log)) {
    if (log_->earlier_bytes() > 0) earlier_.emplace(log_->path(), 0, log_->earlier_bytes());
}

LoggedLines::~LoggedLines() {
    const Instant began = this_instant();
    try {
        while (const auto line = source_->next(0)) {
            log(*line);
            if (seconds_since(began) > StreamLog::farewell) break; // more comes than can be taken
        }
    } catch (const OutputError& e) {
        say(e.what());
    }
}

void LoggedLines::log(const Line& line) {
    log_->add({.kind = LogEntry::Kind::line,
               .arrival = line.arrival,
               .text = line.text,
               .whole = line.whole});
}

std::optional<Lines::Line> LoggedLines::next(double timeout) {
    while (earlier_) {
        const double before = now_;
        auto line = earlier_->next(0);
        now_ = earlier_->now();
        if (earlier_->over()) earlier_.reset();
        if (line) {
            line->number = ++lines_;
            line->arrived = {};
            return line;
        }
        if (!std::isnan(now_) && !(now_ == before)) return {}; // a tick
    }
    auto line = source_->next(timeout);
    if (line) {
        line->number = ++lines_;
        if (line->arrival < now_) line->arrival = now_; // it arrived during the tick
        if (!std::isnan(line->arrival)) now_ = line->arrival;
        log(*line);
    } else if (const double now = source_->now(); StreamLog::is_tick_due(now_, now)) {
        now_ = now;
        log_->add({.kind = LogEntry::Kind::tick, .arrival = now});
    }
    return line;
}

std::unique_ptr<Lines> open_lines(const std::filesystem::path& stream) {
    if (records_of_log(stream)) return std::make_unique<ReplayedLines>(stream, 0);
    return std::make_unique<LineSource>(stream);
}

} // namespace bris
