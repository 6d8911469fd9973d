#pragma once

#include "engine/io/broker_link.hpp"

#include <cstdint>
#include <deque>
#include <utility>

namespace bris {

/// Messages that wait to be taken, of a bounded size: the oldest are dropped for new ones.
class MessageQueue {
public:
    /// `most_bytes`: of all messages together.
    explicit MessageQueue(std::size_t most_bytes) : most_bytes_(most_bytes) {}
    bool empty() const { return messages_.empty(); }
    /// Returns the number of messages that were dropped for this one.
    std::uint64_t push(BrokerMessage message) {
        bytes_ += size_of(message);
        messages_.push_back(std::move(message));
        std::uint64_t dropped = 0;
        for (; bytes_ > most_bytes_; ++dropped) (void)pop();
        return dropped;
    }
    /// The oldest message; there must be one.
    BrokerMessage pop() {
        BrokerMessage first = std::move(messages_.front());
        messages_.pop_front();
        bytes_ -= size_of(first);
        return first;
    }

private:
    static std::size_t size_of(const BrokerMessage& m) {
        return m.payload.size() + m.topic.size() + sizeof m;
    }
    std::size_t most_bytes_, bytes_ = 0;
    std::deque<BrokerMessage> messages_;
};

} // namespace bris
