#include "engine/progress.hpp"

#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

namespace bris {

namespace {

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

/// Progress of a run at one time.
struct Mark {
    double fraction = 0;
    Instant time{};
};

/// Rate of progress of a phase, measured from the older of two marks, which follow the run at
/// intervals of a twentieth of the phase.
class Rate {
public:
    void begin(const Mark& now) { older_ = newer_ = now; }
    void update(const Mark& now) {
        if (now.fraction - newer_.fraction < 0.05) return;
        older_ = newer_;
        newer_ = now;
    }
    /// Time (s) until the phase ends; nothing until enough progress was measured.
    std::optional<double> time_left(const Mark& now) const {
        const double done = now.fraction - older_.fraction,
                     elapsed = std::chrono::duration<double>(now.time - older_.time).count();
        if (done < 1e-3 || elapsed < 0.5) return {};
        return elapsed * (1 - now.fraction) / done;
    }

private:
    Mark older_, newer_;
};

} // namespace

struct Progress::State {
    struct Slot {
        PhaseProgress now;
        Instant time{};
        Rate rate;
        bool shown = false;
    };

    /// "shear 42 %, axial strain 3.4 %, eta 01:23 | shear 40 %, ..." for the runs in progress.
    std::string line() const {
        std::string text;
        for (const Slot& slot : slots) {
            if (!slot.shown) continue;
            if (!text.empty()) text += " | ";
            text += slot.now.phase;
            const double fraction = slot.now.fraction;
            if (fraction >= 0) text += fmt::format(" {:.0f} %", std::floor(100 * fraction));
            if (!slot.now.status.empty()) text += ", " + slot.now.status;
            if (fraction < 0 || fraction >= 1) continue;
            const auto left = slot.rate.time_left({fraction, slot.time});
            text += ", eta " + (left ? duration(*left) : "--:--");
        }
        return text;
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
    Instant last_shown{};
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

void Progress::report(unsigned slot, const PhaseProgress& now) {
    if (state_->style == Style::quiet) return;
    const std::lock_guard lock(state_->mutex);
    State::Slot& mine = state_->slots.at(slot);
    if (now.phase.empty()) {
        mine.shown = false;
        return;
    }
    const Instant time = this_instant();
    const bool begins = !mine.shown || now.phase != mine.now.phase ||
                        // of a new or restarted run
                        now.fraction < mine.now.fraction;
    mine.now = now;
    mine.now.fraction = std::isfinite(now.fraction) ? std::min(now.fraction, 1.0) : -1;
    mine.time = time;
    mine.shown = true;
    if (begins)
        mine.rate.begin({mine.now.fraction, time});
    else
        mine.rate.update({mine.now.fraction, time});
    const double interval = state_->style == Style::rewritten ? 0.5 : 10;
    if (state_->ever_shown && seconds_since(state_->last_shown) < interval) return;
    state_->last_shown = time;
    state_->ever_shown = true;
    state_->show();
}

void Progress::pause() {
    const std::lock_guard lock(state_->mutex);
    state_->end_line();
}

} // namespace bris
