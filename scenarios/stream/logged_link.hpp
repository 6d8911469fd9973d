#pragma once

#include "engine/io/broker_link.hpp"
#include "scenarios/stream/log_replay.hpp"

#include <memory>
#include <optional>

namespace bris {

/// What a run received from a broker, again. That a session began it says by own_topic.
class ReplayedLink : public BrokerLink {
public:
    /// `speed`: relative to the times of arrival; 0: at once. `to`: where publications go; null:
    /// nowhere; it has to live longer. `until`: bytes of the log. Throws like StreamLogReader.
    ReplayedLink(const std::filesystem::path& path, double speed, BrokerLink* to,
                 std::uint64_t until = std::numeric_limits<std::uint64_t>::max())
        : replay_(path, speed, until), to_(to) {}
    /// Nothing also at a tick.
    std::optional<BrokerMessage> next(double timeout) override;
    bool over() const override { return replay_.over(); }
    double now() const override { return replay_.now(); }
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override {
        return to_ == nullptr || to_->publish(topic, payload, delivery);
    }
    BrokerCounters counters() const override { return counters_; }

private:
    LogReplay replay_;
    BrokerLink* to_;
    BrokerCounters counters_;
};

/// A link whose messages, both ways, are logged as they pass, after those of the earlier sessions
/// of the log. What its user receives, and the time `now`, is what a replay of the log shows: while
/// nothing arrives, `now` goes on in ticks of a second, which are logged too.
class LoggedLink : public BrokerLink {
public:
    /// The link has to live longer. Throws like StreamLogReader.
    LoggedLink(BrokerLink& link, std::shared_ptr<StreamLog> log);
    ~LoggedLink() override; ///< logs what has arrived and was not taken
    std::optional<BrokerMessage> next(double timeout) override;
    bool over() const override { return !earlier_ && link_.over(); }
    double now() const override { return now_; }
    bool is_repeating() const override { return earlier_.has_value(); }
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override;
    BrokerCounters counters() const override { return link_.counters(); }

private:
    void log(const BrokerMessage& message);

    BrokerLink& link_;
    std::shared_ptr<StreamLog> log_;
    std::optional<ReplayedLink> earlier_;
    double now_ = no_arrival;
    bool begun_ = false;
};

} // namespace bris
