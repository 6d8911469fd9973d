#pragma once

#include "engine/io/arrival.hpp"
#include "engine/stopwatch.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace bris {

struct BrokerMessage {
    std::string topic, payload;
    bool retained = false; ///< kept by the broker from before the subscription
    Instant arrived = {};  ///< {}: in an earlier session of a run that was resumed
    double time = 0;       ///< s since 1970 UTC, of the arrival (arrival_now)
};

/// What a client counts.
struct BrokerCounters {
    std::uint64_t received = 0, published = 0;
    std::uint64_t acknowledged = 0;  ///< published, and confirmed by the broker
    std::uint64_t dropped = 0;       ///< received, but the queue was full: the oldest ones
    std::uint64_t too_large = 0;     ///< received, but longer than `largest`
    std::uint64_t unpublished = 0;   ///< not sent: no connection, or too many wait to be sent
    std::uint64_t refused = 0;       ///< published, but refused by the broker
    std::uint64_t breaks = 0;        ///< of the connection
    std::uint64_t lost_sessions = 0; ///< breaks after which the broker had kept nothing
};

/// Messages from and to a broker: a connection (BrokerClient), one whose messages are
/// logged (LoggedLink), or one that gives again what was logged (ReplayedLink). Used by one thread.
class BrokerLink {
public:
    enum class Delivery {
        once_at_most,
        at_least_once, ///< sent again until the broker has confirmed it
        retained       ///< the same; the broker keeps the last one of each topic
    };
    /// Topic under which a link tells, among its messages, what became of itself: "began",
    /// "broken", "connected", or "session lost" (connected, but nothing was kept meanwhile). Only
    /// for those who subscribe it; a broker never sees it.
    static constexpr const char* own_topic = "$link";

    virtual ~BrokerLink() = default;
    /// The next message; waits at most `timeout` (s). Nothing: none came, the user stops the run,
    /// or the link is over.
    virtual std::optional<BrokerMessage> next(double timeout) = 0;
    /// Whether no message can come any more.
    virtual bool over() const { return false; }
    /// Time (s since 1970 UTC) by which all that arrived was given; it goes on while nothing
    /// arrives.
    virtual double now() const { return arrival_now(); }
    /// Whether what comes was given before, in an earlier session of a run that was resumed.
    virtual bool is_repeating() const { return false; }
    /// Publishes; never waits. Returns false if the message is not sent.
    virtual bool publish(const std::string& topic, const std::string& payload,
                         Delivery delivery) = 0;
    virtual BrokerCounters counters() const = 0;
};

} // namespace bris
