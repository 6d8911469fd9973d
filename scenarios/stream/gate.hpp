#pragma once

#include "scenarios/sensors/recording.hpp"
#include "scenarios/stream/clock.hpp"
#include "scenarios/stream/counter.hpp"
#include "scenarios/stream/record_stream.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Numbers of what was left out, and the first example of each kind.
class Accounts {
public:
    void add(LeftOut reason, const std::string& example, std::uint64_t count = 1);
    std::uint64_t count(LeftOut reason) const { return counts_[static_cast<std::size_t>(reason)]; }
    /// Of all reasons but copies of what was used.
    std::uint64_t lost() const;
    std::uint64_t total() const;
    /// A line for each kind: "3 records of an impossible time: line 41: ...".
    std::string report() const;

private:
    std::array<std::uint64_t, kinds_left_out> counts_{};
    std::array<std::string, kinds_left_out> examples_;
};

/// A record that has passed the gate.
struct GatedRecord {
    unsigned id = 0;
    std::size_t segment = 0; ///< of its clock
    double t = 0;            ///< s, by the clock of its source, unwrapped
    std::int64_t count = -1; ///< sample count, unwrapped; -1: the record has none
    StreamRecord record;
    double turns = 0; ///< s, of the wraps in t
};

/// Where a record stands, for messages: "line 41: sensor 1: t = 10.25 s".
std::string place_of(const StreamRecord& record, double t);

/// Where the times of a segment come from.
enum class TimeBasis {
    arrival, ///< the lower envelope of arrival less own time
    own,     ///< its own time less the stated clock_offset: nothing arrived at its own rate
    others,  ///< the times of the other sources, between whose records its own stand
    unknown
};

/// The one gate for records of SmartRocks, by whatever way they come: a clock and a counter for
/// each source. It reads no clock of its own: the same lines with the same arrivals give the same.
class Gate {
public:
    /// The sources are the sensors of the metadata.
    explicit Gate(const std::vector<SensorInfo>& infos);
    /// Takes a record, and returns those that pass with it: none while it is held, several when it
    /// agrees with those that were held. What is left out is in the accounts.
    std::vector<GatedRecord> take(StreamRecord record);
    /// Time passes without records.
    void tick(double arrival);
    /// No record will come: what is held is left out.
    void end();
    void leave_out(LeftOut reason, const std::string& example, std::uint64_t count = 1) {
        accounts_.add(reason, example, count);
    }

    struct Offset {
        TimeBasis basis = TimeBasis::unknown;
        double seconds = 0; ///< to be added to the unwrapped own time
    };
    /// The offset of a segment's times near `t` (unwrapped own time).
    Offset offset(unsigned id, std::size_t segment, double t) const;
    /// Common time of an unwrapped own time of a segment; NaN: unknown.
    double common_time(unsigned id, std::size_t segment, double t) const;
    /// Common time that a source has reached; NaN: unknown, or nothing was received.
    double reached(unsigned id) const;
    /// Share of an interval of common time in which a source recorded.
    double coverage(unsigned id, double from, double to) const;
    /// Latest arrival; NaN: nothing has arrived, as from a file.
    double now() const { return now_; }
    /// Whether times come from arrivals.
    bool goes_by_arrival() const;
    const Accounts& accounts() const { return accounts_; }
    std::uint64_t received() const { return received_; }
    /// Records of a source that passed.
    std::uint64_t passed(unsigned id) const { return sources_.at(id).passed; }
    /// Records that are held, and the first of them.
    struct Waiting {
        std::uint64_t records = 0;
        std::string first;
    };
    Waiting waiting() const;
    /// Whether the clock of a segment wraps too soon for its silences and delays.
    bool is_too_short(unsigned id, std::size_t segment) const;
    /// Restarts and wraps of a source's clock and counts: ", its clock wrapped 2 times"; empty: the
    /// usual.
    std::string changes(unsigned id) const;
    /// What was found of the clocks: restarts, wraps, offsets that are not those stated.
    std::string report() const;

private:
    struct Source {
        SensorInfo info;
        SensorClock clock;
        Counter counter;
        std::map<std::uint64_t, std::vector<StreamRecord>> held = {}; // by chain
        std::uint64_t passed = 0;
        double latest = 0;                                  // s, unwrapped, of the current segment
        std::vector<std::pair<double, double>> ranges = {}; // own times of segments that went on
    };
    void forget(const Source& source, const std::vector<StreamRecord>& held);
    bool agrees_with_most(const Source& source, const SensorClock::Segment& segment) const;
    double time_of_others(unsigned id) const;
    GatedRecord pass(Source& source, StreamRecord record, const SensorClock::Decision& decision);

    std::map<unsigned, Source> sources_;
    Accounts accounts_;
    std::uint64_t received_ = 0;
    double now_ = no_arrival;
    bool ended_ = false;
};

} // namespace bris
