#pragma once

#include "engine/stopwatch.hpp"

#include <limits>
#include <mutex>
#include <string>

namespace bris {

/// What a run tells those who listen at a broker, so that they can tell a run that works from one
/// that hangs, was killed or lost its connection:
///     bris/run/NAME       JSON, retained, every second: state ("running", "ended" after its last
///                         result, "stopped" before it), time and began (s since 1970 UTC), beat
///                         (counts from 1), doing, left_s (until that is done; null: unknown),
///                         silent_s (since the computation last gave a sign)
///     bris/run/NAME/gone  JSON, retained: {"gone": true} is the last will, which the broker
///                         publishes when the connection breaks; false while there is one
/// The thread of a connection sends them, any thread may call any member.
class SignsOfLife {
public:
    static constexpr double interval = 1; ///< s between heartbeats

    /// `run`: name; characters that a topic cannot have are replaced.
    explicit SignsOfLife(const std::string& run);

    std::string topic() const { return topic_; }
    std::string topic_of_will() const { return topic_ + "/gone"; }
    static std::string will(bool gone) { return gone ? "{\"gone\": true}" : "{\"gone\": false}"; }

    /// What the run does from now on, and the time (s) until that is done; NaN: unknown.
    void report(const std::string& doing, double left = std::numeric_limits<double>::quiet_NaN());
    /// The computation goes on.
    void sign();
    /// All results are published: the run ends.
    void end();

    bool is_due() const;
    /// The next heartbeat. `time`: s since 1970 UTC. `last`: the run ends with it.
    std::string heartbeat(double time, bool last = false);

private:
    const std::string topic_;
    mutable std::mutex mutex_; // of all below
    std::string doing_ = "starting";
    double left_ = std::numeric_limits<double>::quiet_NaN(); // s, at reported_
    Instant reported_ = this_instant(), signed_ = reported_, beaten_ = {};
    double began_ = 0; // s since 1970 UTC, of the first heartbeat
    unsigned long beats_ = 0;
    bool ended_ = false;
};

} // namespace bris
