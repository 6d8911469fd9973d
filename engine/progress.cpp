#include "engine/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

namespace bris {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

/// 75 -> "01:15", 5025 -> "1:23:45".
std::string duration(double seconds) {
    const auto whole = static_cast<long>(std::min(std::ceil(seconds), 3.6e8));
    const long h = whole / 3600, m = whole / 60 % 60, s = whole % 60;
    return h > 0 ? fmt::format("{}:{:02}:{:02}", h, m, s) : fmt::format("{:02}:{:02}", m, s);
}

std::size_t terminal_width(std::FILE* out) {
    winsize size{};
    if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
    return size.ws_col;
}

Progress::Style resolved(Progress::Style style, std::FILE* out) {
    if (style != Progress::Style::automatic) return style;
    return isatty(fileno(out)) ? Progress::Style::rewritten : Progress::Style::lines;
}

} // namespace

struct Progress::State {
    struct Slot {
        double fraction = 0;
        double first_fraction = 0; // where it began: not 0 in a resumed run
        Clock::time_point since, started;
        bool reported = false;
        std::string text;
    };

    /// "42 %  shear 3.2 %  eta 01:23 | 40 %  ..." for the worlds that have reported.
    std::string line() const {
        std::string text;
        double longest = 0;
        bool known = true;
        for (const Slot& slot : slots) {
            if (!slot.reported) continue;
            text += fmt::format("{}{:3.0f} %  {}", text.empty() ? "" : "  |  ", 100 * slot.fraction,
                                slot.text);
            const double done = slot.fraction - slot.first_fraction;
            if (slot.fraction >= 1) continue;
            known = known && done > 0;
            if (done > 0)
                longest = std::max(longest, seconds_between(slot.started, slot.since) *
                                                (1 - slot.fraction) / done);
        }
        return text + "  eta " + (known ? duration(longest) : "--:--");
    }

    void show() {
        std::string text = line();
        if (style == Style::rewritten) {
            text.resize(std::min(text.size(), terminal_width(out) - 1));
            fmt::print(out, "\r{}\033[K", text);
            line_open = true;
        } else {
            fmt::print(out, "{}\n", text);
        }
        std::fflush(out);
    }

    void end_line() {
        if (!line_open) return;
        fmt::print(out, "\n");
        std::fflush(out);
        line_open = false;
    }

    std::mutex mutex;
    std::vector<Slot> slots;
    Style style;
    std::FILE* out;
    Clock::time_point shown{};
    bool ever_shown = false;
    bool line_open = false;
};

Progress::Progress(unsigned slots, Style style, std::FILE* out)
    : state_(std::make_unique<State>()) {
    state_->slots.resize(slots);
    state_->style = resolved(style, out);
    state_->out = out;
}

Progress::~Progress() { pause(); }

void Progress::report(unsigned slot, double fraction, const std::string& text) {
    if (state_->style == Style::quiet) return;
    const std::lock_guard lock(state_->mutex);
    State::Slot& mine = state_->slots.at(slot);
    const auto now = Clock::now();
    fraction = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
    if (!mine.reported || fraction < mine.fraction) {
        mine.first_fraction = fraction; // a new run in this slot, or one that began again
        mine.started = now;
        mine.reported = true;
    }
    const bool finished = fraction >= 1 && mine.fraction < 1;
    mine.fraction = fraction;
    mine.since = now;
    mine.text = text;
    const double interval = state_->style == Style::rewritten ? 0.5 : 10;
    if (state_->ever_shown && !finished && seconds_between(state_->shown, now) < interval) return;
    state_->shown = now;
    state_->ever_shown = true;
    state_->show();
}

void Progress::pause() {
    const std::lock_guard lock(state_->mutex);
    state_->end_line();
}

} // namespace bris
