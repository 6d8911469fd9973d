#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace bris {

/// Sequence numbers of one sensor's messages: says what each of them is, and counts what was lost.
/// Times are judged by the Gate, behind which the samples are used. Takes a bounded amount of
/// memory.
class SequenceTrack {
public:
    struct Message {
        std::uint32_t sequence; ///< of the first sample
        std::uint32_t samples;
        double time;            ///< s, of the first sample
        double interval;        ///< s
        std::uint64_t hash = 0; ///< of the payload
    };
    enum class Verdict {
        accepted,
        late,          ///< fills a gap: accepted
        duplicate,     ///< came before
        contradiction, ///< the same sequence numbers came before with other contents
        held,          ///< fits nothing before: held until others follow it
        held_anew,     ///< the same, and what was held before is to be forgotten
        adopted,       ///< follows those that are held: they and this one are accepted
        rival          ///< follows a second sequence while the first goes on: two sensors, one id
    };
    struct Counters {
        std::uint64_t samples = 0; ///< accepted
        std::uint64_t missing = 0, gaps = 0, late = 0, duplicates = 0, contradictions = 0;
        std::uint64_t pauses = 0;    ///< the clock went on without samples
        std::uint64_t restarts = 0;  ///< the sequence or the clock began anew
        std::uint64_t rivals = 0;    ///< messages of a second sensor with the same id
        std::uint64_t forgotten = 0; ///< messages that fitted nothing
    };
    Verdict take(const Message& message);
    const Counters& counters() const { return counters_; }

private:
    using Interval = std::pair<std::int64_t, std::int64_t>; // [from, to) of missing samples
    void accept(const Message& message);
    bool fills_gap(std::int64_t from, std::int64_t to);
    /// Whether a message of this sequence number and time came lately, and with these contents.
    Verdict known(const Message& message) const;
    Verdict unexpected(const Message& message);
    void begin_at(const Message& message);
    void remember(const Message& message);

    bool begun_ = false;
    std::int64_t next_ = 0; // expected sequence number, unwrapped
    double last_time_ = 0;  // of the sample before
    std::vector<Interval> missing_;
    std::array<Message, 1024> recent_{};
    std::size_t recent_count_ = 0;
    Message held_{}; // the last one that is held
    unsigned held_count_ = 0;
    std::uint64_t held_samples_ = 0;
    std::uint64_t accepted_since_held_ = 0; // messages
    std::uint64_t rivals_alone_ = 0;        // messages of a second sensor since one of the first
    Counters counters_;
};

} // namespace bris
