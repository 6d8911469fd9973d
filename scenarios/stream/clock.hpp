#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace bris {

/// Why a record that was received is not used.
enum class LeftOut {
    unreadable,    ///< no record at all
    unknown_id,    ///< of no sensor of the metadata
    no_time,       ///< without a number t
    impossible,    ///< its time fits neither the records before nor those after it
    again,         ///< a copy of a record that was used
    contradiction, ///< other numbers at a time that was recorded before
    another_clock, ///< a second clock under the same id, while the first one goes on
    time_unknown,  ///< nothing says when it was recorded
    too_late,      ///< the verdict on its time was final
    no_room        ///< beyond the memory that is set aside for records that wait
};
inline constexpr std::size_t kinds_left_out = 10;
const char* text_of(LeftOut reason);

/// The clock of one source of records, which may begin anywhere, wrap, restart, be set, drift by
/// up to 200 ppm, and be wrong in single records. It sorts the records into *segments*: within one
/// the clock went on undisturbed. A record whose time does not follow is held until three different
/// ones that follow each other agree with it; what they are is then decided:
///   - ahead, and not later than they arrived: a gap;
///   - back to where the clock has no records, and faster than they could be recorded: stored
///     records that come late;
///   - back by a usual period of a clock (16, 24, 32 bits of us or ms, a day): a wrap;
///   - copies of records that were used: left out;
///   - anything else: the clock was set or began again, a new segment.
/// The offset of a segment is the lower envelope of arrival less own time: records only arrive
/// late. It may rise by 200 ppm of the time since, and is *confirmed* when records arrived at the
/// rate of their own times. Pure function of the readings; memory is bounded.
class SensorClock {
public:
    struct Reading {
        double t;                  ///< s, by the source
        double arrival;            ///< s; NaN: none, as in a file
        double others;             ///< s, time that the other sources have reached; NaN: unknown
        std::uint64_t content = 0; ///< hash of the record
    };
    enum class Action { keep, hold, leave_out };
    struct Decision {
        Action record = Action::hold;
        std::uint64_t chain = 0;     ///< of records that follow each other, in which it is held
        Action held = Action::hold;  ///< what becomes of those that are held in that chain
        std::uint64_t forgotten = 0; ///< a chain that is left out as impossible; 0: none
        LeftOut reason = LeftOut::impossible;
        std::size_t segment = 0; ///< of what is kept
        double turns = 0;        ///< s, to be added to the t of what is kept: wraps so far
        bool begins = false;     ///< the segment begins with it
        bool is_late = false;
    };
    struct Segment {
        std::size_t number = 0; ///< counted over all, also those that were forgotten
        bool went_back = false; ///< it began with an earlier time than the one before had reached
        double turns = 0;       ///< s
        double first = 0, last = 0;        ///< s, unwrapped times
        double spacing = 0;                ///< s, between samples, smoothed
        double period = 0;                 ///< s, of the wraps; 0: none so far
        std::optional<double> envelope;    ///< arrival less unwrapped time at `last`, s
        double support_t = 0, support = 0; ///< the record that set it
        bool confirmed = false;
        double largest_lag = 0; ///< s, of records that followed directly
        /// Time of the others less its own, over the records of the segment, s.
        double least_to_others = 1e300, most_to_others = -1e300, first_with_others = 0;
        std::vector<std::pair<double, double>> envelopes; ///< t and value, every ten minutes
        std::vector<std::pair<double, double>> covered;   ///< intervals of unwrapped times
        /// Arrival less own time near `t` (unwrapped); NaN: not confirmed.
        double offset_at(double t) const;
        /// Whether the clock wraps too soon for its silences and delays.
        bool is_too_short() const;
    };

    /// `rate`: Hz, nominal.
    explicit SensorClock(double rate);
    Decision take(const Reading& reading);
    /// Null: forgotten.
    const Segment* segment(std::size_t number) const;
    /// Whether a segment has records at this time (s, by the source) or on both sides of it without
    /// a gap.
    bool has_recorded(double t) const;
    const Segment* current() const { return segments_.empty() ? nullptr : &segments_.back(); }
    std::uint64_t restarts() const { return restarts_; }
    std::uint64_t wraps() const { return wraps_; }

private:
    struct Known {
        double t;
        std::uint64_t content;
    };
    bool was_used(const Reading& r) const;
    std::optional<Decision> follows(Segment& s, const Reading& r, bool is_current);
    /// Records that are held and follow each other.
    struct Chain {
        std::uint64_t number;
        std::vector<Reading> readings;
        std::uint64_t kept_meanwhile = 0; ///< records of the segments
    };
    Decision hold(const Reading& r);
    Decision decide(Chain& chain);
    Decision adopt(Chain& chain, Segment& s, bool begins, bool is_late);
    Decision drop(const Chain& chain, LeftOut reason);
    Segment& begin(const Chain& chain, bool went_back);
    void enter(Segment& s, const Reading& r);
    void set_envelope(Segment& s, double t, double lag) const;
    std::optional<double> wrap_of(const Segment& s, double t) const;
    bool is_delayed(const Chain& chain, const Segment& s, double period) const;
    double near_of(double spacing) const;

    double rate_;
    std::vector<Segment> segments_;
    std::size_t begun_ = 0; // segments so far
    std::vector<Chain> chains_;
    std::uint64_t chained_ = 0, restarts_ = 0, wraps_ = 0;
    std::array<Known, 512> recent_{};
    std::vector<Known> by_second_; // one record of each second
    std::size_t recent_count_ = 0, second_count_ = 0;
    double second_ = -1e300;
};

} // namespace bris
