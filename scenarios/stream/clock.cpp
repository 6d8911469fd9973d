#include "scenarios/stream/clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double drift = 200e-6;     // largest relative drift of a clock
constexpr double step = 5;           // s by which a time may be ahead of its arrival at most
constexpr double scatter = 2;        // s of delay within which records confirm the envelope
constexpr double confirming = 10;    // s of own time after which they do
constexpr double shortest_near = 10; // s, and so many samples, that may lie between two records
constexpr double near_samples = 20;  // that follow each other
constexpr double long_gap = 3600;    // s; without arrivals a longer one begins a segment
constexpr std::size_t agreeing = 3;  // records
constexpr double exchanged = 3;      // samples by which the first records may be out of order
constexpr double deciding = 2;       // s of own time that tell stored from live records
constexpr double between_envelopes = 600; // s
constexpr std::size_t most_envelopes = 64, most_covered = 4096, most_segments = 8;
constexpr std::size_t most_held = 20000, most_chains = 4, most_seconds = 4096;
constexpr std::array periods{65.536,      16777.216,   2147.483648, 4294.967296,
                             2147483.648, 4294967.296, 65536.0,     86400.0}; // s

} // namespace

const char* text_of(LeftOut reason) {
    switch (reason) {
    case LeftOut::unreadable:
        return "unreadable";
    case LeftOut::unknown_id:
        return "of an unknown id";
    case LeftOut::no_time:
        return "without a time";
    case LeftOut::impossible:
        return "of an impossible time";
    case LeftOut::again:
        return "sent again";
    case LeftOut::contradiction:
        return "with other numbers at a time that was recorded before";
    case LeftOut::another_clock:
        return "of another clock under the same id";
    case LeftOut::time_unknown:
        return "of unknown time";
    case LeftOut::too_late:
        return "too late";
    case LeftOut::no_room:
        return "beyond the memory for records that wait";
    }
    return "";
}

double SensorClock::Segment::offset_at(double t) const {
    if (!confirmed) return std::numeric_limits<double>::quiet_NaN();
    double nearest = *envelope, distance = std::abs(t - last);
    for (const auto& [at, value] : envelopes)
        if (std::abs(t - at) < distance) {
            distance = std::abs(t - at);
            nearest = value;
        }
    return nearest;
}

bool SensorClock::Segment::is_too_short() const {
    return period > 0 && largest_lag >= 0.5 * period;
}

SensorClock::SensorClock(double rate) : rate_(rate) {}

double SensorClock::near_of(double spacing) const {
    return std::max({shortest_near, near_samples / rate_, near_samples * spacing});
}

const SensorClock::Segment* SensorClock::segment(std::size_t number) const {
    const auto found = std::ranges::find(segments_, number, &Segment::number);
    return found == segments_.end() ? nullptr : &*found;
}

bool SensorClock::has_recorded(double t) const {
    return std::ranges::any_of(segments_, [&](const Segment& s) {
        return std::ranges::any_of(s.covered, [&](const auto& range) {
            return range.first <= t + s.turns && t + s.turns <= range.second;
        });
    });
}

bool SensorClock::was_used(const Reading& r) const {
    const auto is_it = [&](const Known& k) { return k.t == r.t && k.content == r.content; };
    return std::any_of(recent_.begin(),
                       recent_.begin() +
                           static_cast<std::ptrdiff_t>(std::min(recent_count_, recent_.size())),
                       is_it) ||
           std::ranges::any_of(by_second_, is_it);
}

SensorClock::Decision SensorClock::take(const Reading& r) {
    if (!segments_.empty()) {
        if (const auto decided = follows(segments_.back(), r, true)) return *decided;
        for (std::size_t k = segments_.size() - 1; k-- > 0;)
            if (const auto decided = follows(segments_[k], r, false)) return *decided;
    }
    return hold(r);
}

/// Whether a record goes on with a segment, or fills a gap in it, or is known; nothing: it may be
/// anything.
std::optional<SensorClock::Decision> SensorClock::follows(Segment& s, const Reading& r,
                                                          bool is_current) {
    const double t = r.t + s.turns, ahead = t - s.last;
    const Decision kept{.record = Action::keep, .segment = s.number, .turns = s.turns};
    if (ahead > 0) {
        if (ahead > near_of(s.spacing)) return {};
        if (s.confirmed && t + *s.envelope > r.arrival + step + drift * ahead)
            return {}; // from the future
        // an earlier segment goes on only by stored records: live ones are of another clock
        if (!is_current && !(s.confirmed && r.arrival - t > *s.envelope + scatter)) return {};
        enter(s, r);
        return kept;
    }
    if (was_used(r)) return Decision{.record = Action::leave_out, .reason = LeftOut::again};
    if (t < s.first) return {};
    const auto after =
        std::ranges::upper_bound(s.covered, t, {}, &std::pair<double, double>::first);
    const bool is_covered = after != s.covered.begin() && t <= std::prev(after)->second;
    if (is_covered) return {};
    if (!is_current && !s.confirmed) return {};
    enter(s, r);
    Decision late = kept;
    late.is_late = true;
    return late;
}

void SensorClock::enter(Segment& s, const Reading& r) {
    const double t = r.t + s.turns;
    if (t > s.last) {
        const double gap = t - s.last;
        // a longer gap may be one of records that come late
        if (gap < 5 * s.spacing) s.spacing += 0.1 * (std::min(gap, 1.5 * s.spacing) - s.spacing);
        if (gap <= 1.5 * s.spacing && !s.covered.empty())
            s.covered.back().second = t;
        else
            s.covered.emplace_back(t, t);
    } else {
        const auto after =
            std::ranges::upper_bound(s.covered, t, {}, &std::pair<double, double>::first);
        const auto at = s.covered.insert(after, {t, t});
        if (const auto next = std::next(at);
            next != s.covered.end() && next->first - t <= 1.5 * s.spacing) {
            at->second = next->second;
            s.covered.erase(next);
        }
        if (at != s.covered.begin() && at->first - std::prev(at)->second <= 1.5 * s.spacing) {
            std::prev(at)->second = at->second;
            s.covered.erase(at);
        }
    }
    if (s.covered.size() > most_covered) { // the oldest gap is not filled any more
        s.covered[1].first = s.covered[0].first;
        s.covered.erase(s.covered.begin());
    }
    if (std::isfinite(r.arrival)) set_envelope(s, t, r.arrival - t);
    if (std::isfinite(r.others)) {
        const double lead = r.others - t;
        const double least = std::min(s.least_to_others, lead),
                     most = std::max(s.most_to_others, lead);
        const bool goes_on = most - least <= scatter; // or one of the two has jumped
        if (!goes_on || s.most_to_others < s.least_to_others) s.first_with_others = t;
        s.least_to_others = goes_on ? least : lead;
        s.most_to_others = goes_on ? most : lead;
    }
    s.last = std::max(s.last, t);
    for (Chain& chain : chains_) ++chain.kept_meanwhile;
    recent_[recent_count_++ % recent_.size()] = {r.t, r.content};
    if (std::abs(r.t - second_) < 1) return;
    second_ = r.t;
    if (by_second_.size() < most_seconds) by_second_.emplace_back();
    by_second_[second_count_++ % most_seconds] = {r.t, r.content};
}

/// The lower envelope of arrival less own time, which may rise by the largest drift.
void SensorClock::set_envelope(Segment& s, double t, double lag) const {
    if (!s.envelope) {
        s.envelope = s.support = lag;
        s.support_t = t;
        s.envelopes.emplace_back(t, lag);
        return;
    }
    if (t <= s.last) { // it came late, and says little of the present
        s.envelope = std::min(*s.envelope, lag + drift * (s.last - t));
        return;
    }
    const double bound = *s.envelope + drift * (t - s.last);
    s.largest_lag = std::max(s.largest_lag, lag - bound);
    s.envelope = std::min(bound, lag);
    if (*s.envelope < s.support - scatter - drift * std::abs(t - s.support_t)) { // not yet found
        s.support = *s.envelope;
        s.support_t = t;
    } else if (lag <= *s.envelope + scatter && t - s.support_t >= confirming) {
        if (!s.confirmed) s.envelopes.assign(1, {t, *s.envelope});
        s.confirmed = true;
        s.support = *s.envelope;
        s.support_t = t - confirming;
    }
    if (t - s.envelopes.back().first < between_envelopes) {
        if (*s.envelope < s.envelopes.back().second) s.envelopes.back().second = *s.envelope;
        return;
    }
    s.envelopes.emplace_back(t, *s.envelope);
    if (s.envelopes.size() > most_envelopes) s.envelopes.erase(s.envelopes.begin());
}

/// Holds a record in the chain that it continues, or in one of its own.
SensorClock::Decision SensorClock::hold(const Reading& r) {
    const double near = near_of(segments_.empty() ? 0 : segments_.back().spacing);
    for (Chain& chain : chains_) {
        const auto at = std::ranges::lower_bound(chain.readings, r.t, {}, &Reading::t);
        const bool is_known = at != chain.readings.end() && at->t == r.t;
        if (is_known && at->content == r.content)
            return {.record = Action::leave_out, .reason = LeftOut::again};
        const double ahead = r.t - chain.readings.back().t;
        const bool follows = ahead > 0 && ahead <= near;
        // the first records of all may have changed places on their way
        const bool is_behind =
            segments_.empty() && !is_known && ahead < 0 && ahead >= -exchanged / rate_;
        if (!follows && !is_behind) continue;
        chain.readings.insert(at, r);
        if (chain.readings.size() < agreeing) return {.chain = chain.number};
        const Decision decided = decide(chain);
        if (decided.held != Action::hold)
            std::erase_if(chains_, [&](const Chain& one) { return one.number == decided.chain; });
        return decided;
    }
    Decision alone{.chain = ++chained_};
    if (chains_.size() == most_chains) {
        alone.forgotten = chains_.front().number;
        chains_.erase(chains_.begin());
    }
    chains_.push_back({chained_, {r}});
    return alone;
}

/// The period by which the clock has wrapped, if it has, before a time that is held.
std::optional<double> SensorClock::wrap_of(const Segment& s, double t) const {
    const auto fits = [&](double period) {
        const double ahead = t + s.turns + period - s.last;
        return ahead > 0 && ahead <= near_of(s.spacing) && t >= -1e-6 && t < near_of(s.spacing) &&
               s.last - s.turns < period;
    };
    for (const double period : periods)
        if (fits(period)) return period;
    return {};
}

/// Whether records that arrive as they are recorded are later than a wrap would have them: then the
/// clock has begun again, by chance near its period.
bool SensorClock::is_delayed(const Chain& chain, const Segment& s, double period) const {
    const Reading &first = chain.readings.front(), &last = chain.readings.back();
    if (!s.confirmed || !std::isfinite(last.arrival)) return false;
    const bool is_live = last.arrival - first.arrival >= 0.5 * (last.t - first.t);
    return is_live && last.arrival - last.t - s.turns - period > *s.envelope + scatter;
}

/// What the records of a chain are: they agree with each other, and not with those before.
SensorClock::Decision SensorClock::decide(Chain& chain) {
    const Reading &first = chain.readings.front(), &last = chain.readings.back();
    if (segments_.empty()) return adopt(chain, begin(chain, false), true, false);
    Segment& s = segments_.back();
    const double ahead = first.t + s.turns - s.last, span = last.t - first.t;
    const bool arrives = std::isfinite(first.arrival), is_long = chain.readings.size() >= most_held;
    const Decision wait{.chain = chain.number};
    if (4 * chain.kept_meanwhile > chain.readings.size()) // the clock before goes on
        return is_long || span >= deciding ? drop(chain, LeftOut::another_clock) : wait;
    if (s.period > 0 && s.confirmed && arrives) { // it may have wrapped several times in a silence
        const double behind = first.arrival - *s.envelope - first.t - s.turns;
        const double turns = std::round(behind / s.period);
        if (turns >= 1) {
            wraps_ += static_cast<std::uint64_t>(turns);
            s.turns += turns * s.period;
            return adopt(chain, s, false, false);
        }
    }
    if (ahead > 0) {
        const bool is_future = arrives ? s.confirmed && first.t + s.turns + *s.envelope >
                                                            first.arrival + step + drift * ahead
                                       : ahead > long_gap;
        if (!is_future) return adopt(chain, s, false, false);
        ++restarts_;
        return adopt(chain, begin(chain, false), true, false);
    }
    if (const auto period = wrap_of(s, first.t); period && !is_delayed(chain, s, *period)) {
        ++wraps_;
        s.period = *period;
        s.turns += *period;
        return adopt(chain, s, false, false);
    }
    if (span < deciding && !is_long) return wait;
    if (std::ranges::any_of(chain.readings, [&](const Reading& r) { return was_used(r); }))
        return drop(chain, LeftOut::again);
    const bool was_stored = arrives && last.arrival - first.arrival < 0.5 * span;
    const bool is_before = first.t + s.turns < s.first;
    if (was_stored && !is_before) return drop(chain, LeftOut::contradiction);
    ++restarts_;
    return adopt(chain, begin(chain, true), true, was_stored);
}

SensorClock::Decision SensorClock::adopt(Chain& chain, Segment& s, bool begins, bool is_late) {
    const Decision all{.record = Action::keep,
                       .chain = chain.number,
                       .held = Action::keep,
                       .segment = s.number,
                       .turns = s.turns,
                       .begins = begins,
                       .is_late = is_late};
    for (const Reading& r : chain.readings) enter(s, r);
    return all;
}

SensorClock::Decision SensorClock::drop(const Chain& chain, LeftOut reason) {
    return {.record = Action::leave_out,
            .chain = chain.number,
            .held = Action::leave_out,
            .reason = reason};
}

SensorClock::Segment& SensorClock::begin(const Chain& chain, bool went_back) {
    if (segments_.size() == most_segments) segments_.erase(segments_.begin());
    const auto& readings = chain.readings;
    Segment& s = segments_.emplace_back();
    s.number = begun_++;
    s.went_back = went_back;
    s.first = readings.front().t;
    s.last = s.first - 1 / rate_;
    std::vector<double> gaps; // some may be those of records that come late
    for (std::size_t k = 1; k < readings.size(); ++k)
        gaps.push_back(readings[k].t - readings[k - 1].t);
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>((gaps.size() - 1) / 2);
    std::ranges::nth_element(gaps, middle);
    s.spacing = *middle;
    return s;
}

} // namespace bris
