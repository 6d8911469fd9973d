#include "engine/progress.hpp"

#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
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

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : " | ") + part;
    return text;
}

std::size_t terminal_width(std::FILE* out) {
    winsize size{};
    if (ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    const char* columns = std::getenv("COLUMNS");
    const int width = columns != nullptr ? std::atoi(columns) : 0;
    return width > 0 ? static_cast<std::size_t>(width) : 80;
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
        if (now.fraction - newer_.fraction < 0.05 || seconds(newer_, now) < shortest) return;
        older_ = newer_;
        newer_ = now;
    }
    /// Time (s) until the phase ends; nothing until enough progress was measured.
    std::optional<double> time_left(const Mark& now) const {
        const double done = now.fraction - older_.fraction, elapsed = seconds(older_, now);
        if (done < 1e-3 || elapsed < shortest) return {};
        return elapsed * (1 - now.fraction) / done;
    }

private:
    static constexpr double shortest = 0.5; // s, from which a rate is measured
    static double seconds(const Mark& from, const Mark& to) {
        return std::chrono::duration<double>(to.time - from.time).count();
    }
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

    static std::string eta(const std::optional<double>& left) {
        return ", eta " + (left ? duration(*left) : "--:--");
    }

    std::string text_of(const Slot& slot, bool with_status) const {
        std::string text = slot.now.phase;
        const double fraction = slot.now.fraction;
        if (fraction >= 0) text += fmt::format(" {:.0f} %", std::floor(100 * fraction));
        if (with_status && !slot.now.status.empty()) text += ", " + slot.now.status;
        if (job_work == 0 && fraction >= 0 && fraction < 1)
            text += eta(slot.rate.time_left({fraction, slot.time}));
        return text;
    }

    /// "all runs 10 %, eta 01:23 | shear 42 %, axial strain 3.4 of 8 % | shear 40 %, ..." for the
    /// runs in progress. What does not fit into `width` columns is left out: first the status of
    /// all runs, then the last runs, whose number is given. A single run is cut.
    std::string line(std::size_t width) const {
        std::vector<std::string> whole, parts;
        if (job_work > 0)
            parts.push_back(fmt::format("all runs {:.0f} %", std::floor(100 * job_now.fraction)) +
                            eta(job_rate.time_left(job_now)));
        whole = parts;
        for (const Slot& slot : slots)
            if (slot.shown) {
                whole.push_back(text_of(slot, true));
                parts.push_back(text_of(slot, false));
            }
        const bool several = std::ranges::count(slots, true, &Slot::shown) > 1;
        std::string text = joined(whole);
        if (text.size() > width && several) text = joined(parts);
        for (std::size_t less = 1; text.size() > width && several && parts.size() > 1; ++less) {
            parts.pop_back();
            text = fmt::format("{} | {} more", joined(parts), less);
        }
        return text.substr(0, width);
    }

    void show() {
        if (style == Style::rewritten) {
            write(fmt::format("\r{}\033[K", line(terminal_width(out) - 1)));
            line_open = true;
        } else {
            write(line(std::string::npos) + "\n");
        }
    }

    void clear_line() {
        if (!line_open) return;
        write("\r\033[K");
        line_open = false;
    }

    // does not throw: it is called while errors are handled, and a run goes on if nobody can see
    // its progress
    void write(const std::string& text) const {
        std::fputs(text.c_str(), out);
        std::fflush(out);
    }

    void end_run(Slot& slot) {
        work_ended += slot.now.work;
        slot.now = {};
        slot.shown = false;
    }

    void update_job(Instant time) {
        if (job_work == 0) return;
        double work = work_ended;
        for (const Slot& slot : slots) work += slot.now.work;
        job_now = {std::min(work / job_work, 1.0), time};
        job_rate.update(job_now);
    }

    std::mutex mutex;
    std::vector<Slot> slots;
    Style style;
    std::FILE* out;
    Instant last_shown{};
    bool ever_shown = false;
    bool line_open = false;
    double job_work = 0, work_ended = 0; // of the job, and of its runs that have ended
    Mark job_now;
    Rate job_rate;
};

Progress::Progress(Style style, std::FILE* out) : state_(std::make_unique<State>()) {
    state_->style = resolved(style, out);
    state_->out = out;
}

Progress::~Progress() { pause(); }

void Progress::begin_job(double work) {
    const std::lock_guard lock(state_->mutex);
    state_->job_work = work;
    state_->work_ended = 0;
    state_->job_now = {0, this_instant()};
    state_->job_rate.begin(state_->job_now);
}

void Progress::job_reached(double work) {
    const std::lock_guard lock(state_->mutex);
    state_->work_ended = work;
    state_->update_job(this_instant());
}

void Progress::report(unsigned slot, const PhaseProgress& now) {
    if (state_->style == Style::quiet) return;
    const std::lock_guard lock(state_->mutex);
    if (slot >= state_->slots.size()) state_->slots.resize(slot + 1);
    State::Slot& mine = state_->slots[slot];
    if (now.phase.empty()) {
        state_->end_run(mine);
        if (std::ranges::none_of(state_->slots, &State::Slot::shown)) state_->clear_line();
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
    state_->update_job(time);
    const double interval = state_->style == Style::rewritten ? 0.5 : 10;
    if (state_->ever_shown && seconds_since(state_->last_shown) < interval) return;
    state_->last_shown = time;
    state_->ever_shown = true;
    state_->show();
}

void Progress::pause() {
    const std::lock_guard lock(state_->mutex);
    state_->clear_line();
}

} // namespace bris
