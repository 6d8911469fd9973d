#pragma once

#include "scenarios/sensors/channels.hpp"
#include "scenarios/stream/gate.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// The numbers that a SmartRock sent at one t, in the order of channel_columns; the bits of `sent`
/// say which of them it sent.
struct SensorSample {
    std::vector<double> numbers = {};
    std::uint64_t sent = 0;
    std::int64_t count = -1; ///< of the sample, unwrapped; -1: the record has none

    bool has(std::size_t first, std::size_t numbers_from_it = 1) const;
};
SensorSample sample_of(const StreamRecord& record);
bool same_numbers(const SensorSample& a, const SensorSample& b);

/// Places of the numbers of some channels in a sample.
namespace in_sample {
inline constexpr std::size_t strain = place_of(&Recording::strain),
                             phase = place_of(&Recording::phase),
                             sequence = place_of(&Recording::sequence),
                             flags = place_of(&Recording::flags);
}

/// What is known of a segment of a sensor's clock (SensorClock), by which it is placed beside the
/// others.
struct SegmentEvidence {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double first = 0, last = 0; ///< s, unwrapped own times
    /// s, the machine's time less its own at the same strain; nothing: too few records with strain.
    std::optional<double> by_strain = {};
    double offset_at_first = unknown, offset_at_last = unknown; ///< s, arrival less own time
    /// Its own times less the clock_offset of the metadata are those of the machine on arrival.
    bool stands = false;
};

/// s to be added to the own times of each segment, so that they are on one axis of time: that of
/// the first segment whose times are known. Nothing: nothing tells when it recorded. Segments do
/// not overlap: one that does by at most `tolerance` (s) begins after the one before.
std::vector<std::optional<double>> shifts_of(const std::vector<SegmentEvidence>& segments,
                                             double clock_offset, double tolerance);

/// A record on the axis of time of its sensor.
struct PlacedSample {
    double t;           ///< s
    std::int64_t count; ///< increases with t; -1: unknown
    const SensorSample* sample;
};

/// All records of a sensor in the order in which they were recorded.
struct SensorTimeline {
    std::vector<PlacedSample> samples = {};
    /// s, t of each record less the machine's last t when the record arrived.
    std::vector<double> ahead = {};
    std::uint64_t of_unknown_time = 0;
    std::string first_unknown = {};
};

/// What a test so far tells of time.
struct TestTimes {
    /// Axial strain of a sample by its own numbers; NaN: it is known by its t alone.
    std::function<double(const SensorSample&)> own_strain;
    /// The machine's time (s) at a strain; NaN: unknown.
    std::function<double(double)> time_at;
    /// s, by which a clock may differ from the machine's; NaN: the machine has no clock.
    double uncertain = SegmentEvidence::unknown;
};

/// Records of one SmartRock that passed the gate, by the segments of its clock.
class SensorRecords {
public:
    explicit SensorRecords(const SensorInfo& info)
        : clock_offset_(info.clock_offset), rate_(info.sampling_rate) {}
    /// `machine_t`: s, the last t of the machine when the record arrived; NaN: none. Returns false
    /// for a record of the same time as one before.
    bool add(const GatedRecord& record, double machine_t);
    /// The sample that was recorded at this time by the present clock, or by one before; null:
    /// none.
    const SensorSample* recorded_at(double raw_t) const;
    /// Adds a record of the present clock that comes late between two others, if its count, or else
    /// its strain, is between theirs: where records are irregular, their times do not tell that one
    /// is missing. Returns false if it is not such a record.
    bool add_between(const StreamRecord& record, double machine_t);
    /// Looks up what the gate knows of a segment by now.
    void update(const Gate& gate, unsigned id, std::size_t segment);
    SensorTimeline timeline(const TestTimes& times) const;
    /// Bits of the numbers sent in any of them.
    std::uint64_t sent() const { return sent_; }

    std::uint64_t received = 0, late = 0, twice = 0;

private:
    struct Segment {
        std::map<double, SensorSample> by_time; // unwrapped own time
        std::vector<double> ahead;
        double turns = 0; // s, of the wraps, at the last record
        double offset_at_first = SegmentEvidence::unknown,
               offset_at_last = SegmentEvidence::unknown;
        bool is_too_short = false; // its clock: t tells nothing
    };
    bool enter(Segment& segment, double t, SensorSample sample, double machine_t);
    SegmentEvidence evidence_of(const Segment& segment, const TestTimes& times) const;
    void append(SensorTimeline& timeline, const Segment& segment, double shift,
                const TestTimes& times) const;

    double clock_offset_, rate_;
    std::map<std::size_t, Segment> segments_;
    std::uint64_t sent_ = 0;
};

} // namespace bris
