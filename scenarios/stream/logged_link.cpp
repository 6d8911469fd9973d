#include "scenarios/stream/logged_link.hpp"

#include "engine/errors.hpp"
#include "engine/message.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

namespace {

BrokerMessage session_message(double arrival) {
    return {BrokerLink::own_topic, "began", false, this_instant(), arrival};
}

} // namespace

std::optional<BrokerMessage> ReplayedLink::next(double timeout) {
    const Instant called = this_instant();
    while (auto entry = replay_.next(std::max(0.0, timeout - seconds_since(called)))) {
        if (entry->kind == LogEntry::Kind::tick) return {};
        if (entry->kind == LogEntry::Kind::session) return session_message(entry->arrival);
        if (entry->kind != LogEntry::Kind::message) continue;
        BrokerMessage m{std::move(entry->topic), std::move(entry->text), entry->retained,
                        this_instant(), entry->arrival};
        if (m.topic != own_topic)
            ++counters_.received;
        else if (m.payload == "broken")
            ++counters_.breaks;
        else if (m.payload == "session lost")
            ++counters_.lost_sessions;
        return m;
    }
    return {};
}

LoggedLink::LoggedLink(BrokerLink& link, std::shared_ptr<StreamLog> log)
    : link_(link), log_(std::move(log)) {
    if (log_->earlier_bytes() > 0)
        earlier_.emplace(log_->path(), 0, nullptr, log_->earlier_bytes());
}

LoggedLink::~LoggedLink() {
    const Instant began = this_instant();
    try {
        while (const auto message = link_.next(0)) {
            log(*message);
            if (seconds_since(began) > StreamLog::farewell) break; // more comes than can be taken
        }
    } catch (const OutputError& e) {
        say(e.what());
    }
}

void LoggedLink::log(const BrokerMessage& m) {
    log_->add({.kind = LogEntry::Kind::message,
               .arrival = m.time,
               .topic = m.topic,
               .text = m.payload,
               .retained = m.retained});
}

std::optional<BrokerMessage> LoggedLink::next(double timeout) {
    while (earlier_) {
        const double before = now_;
        auto message = earlier_->next(0);
        now_ = earlier_->now();
        if (earlier_->over()) earlier_.reset();
        if (message) {
            message->arrived = {};
            return message;
        }
        if (!std::isnan(now_) && !(now_ == before)) return {}; // a tick
    }
    if (!std::exchange(begun_, true)) return session_message(log_->began());
    auto message = link_.next(timeout);
    if (message) {
        if (message->time < now_) message->time = now_; // it arrived during the tick
        now_ = message->time;
        log(*message);
    } else if (const double now = link_.now(); StreamLog::is_tick_due(now_, now)) {
        now_ = now;
        log_->add({.kind = LogEntry::Kind::tick, .arrival = now});
    }
    return message;
}

bool LoggedLink::publish(const std::string& topic, const std::string& payload, Delivery delivery) {
    log_->add({.kind = LogEntry::Kind::published,
               .arrival = arrival_now(),
               .topic = topic,
               .text = payload,
               .retained = delivery == Delivery::retained});
    return link_.publish(topic, payload, delivery);
}

} // namespace bris
