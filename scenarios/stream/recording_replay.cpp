#include "scenarios/stream/recording_replay.hpp"

#include "engine/errors.hpp"
#include "scenarios/stream/sensor_payload.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace bris {

using Delivery = BrokerLink::Delivery;

NodeConfiguration parse_configuration(const std::string& text) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    require(json.is_object(), "expected a JSON object, found something else");
    const auto number = [&](const char* name, double low, double high) {
        const auto found = json.find(name);
        require(found != json.end() && found->is_number(),
                fmt::format("{}: expected a number, found none", name));
        const double x = found->get<double>();
        require(x >= low && x <= high,
                fmt::format("{}: expected {:g} to {:g}, found {:g}", name, low, high, x));
        return x;
    };
    NodeConfiguration c;
    c.revision = static_cast<std::uint64_t>(number("revision", 0, 1e15));
    c.rate_hz = number("rate_hz", 0.01, 5000);
    c.threshold = number("threshold", 0, 1000);
    const auto strategy = json.find("strategy");
    require(strategy != json.end() && (*strategy == "continuous" || *strategy == "triggered"),
            "strategy: expected continuous or triggered, found something else");
    c.strategy = strategy->get<std::string>();
    return c;
}

RecordingReplay::RecordingReplay(BrokerLink& link, const std::vector<std::string>& lines,
                                 double speed)
    : link_(link), speed_(speed) {
    RecordParser parser;
    std::uint64_t number = 0;
    for (const std::string& line : lines)
        if (auto record = parser.parse({++number, line, this_instant(), true}))
            records_.emplace_back(std::move(*record), line);
    for (const auto& [record, line] : records_)
        if (record.has("id")) nodes_[static_cast<unsigned>(record.number("id"))];
    const auto first = std::ranges::find_if(
        records_, [](const auto& r) { return std::isfinite(r.first.number("t")); });
    if (first != records_.end()) first_t_ = first->first.number("t");
    for (const auto& [id, node] : nodes_)
        link_.publish(fmt::format("smartrock/{}/status", id), "{\"status\": \"online\"}",
                      Delivery::retained);
}

bool RecordingReplay::advance() {
    while (const auto message = link_.next(0)) obey(*message);
    const double now = first_t_ + speed_ * seconds_since(began_);
    while (next_ < records_.size() && !(records_[next_].first.number("t") > now) &&
           publish(records_[next_].first, records_[next_].second))
        ++next_;
    return next_ < records_.size();
}

void RecordingReplay::obey(const BrokerMessage& message) {
    const auto from = message.topic.find('/') + 1, to = message.topic.rfind('/');
    const std::string id = message.topic.substr(from, to - from);
    const auto node =
        std::ranges::find_if(nodes_, [&](const auto& n) { return std::to_string(n.first) == id; });
    if (node == nodes_.end()) return; // not one of these sensors
    nlohmann::json answer{{"accepted", true}};
    try {
        node->second.configuration = parse_configuration(message.payload);
        answer["revision"] = node->second.configuration.revision;
    } catch (const InputError& e) {
        answer = {{"accepted", false}, {"reason", e.what()}, {"revision", 0}};
    }
    link_.publish(fmt::format("smartrock/{}/config/ack", id), answer.dump(), Delivery::retained);
}

/// Returns false if the link does not take the record now.
bool RecordingReplay::publish(const StreamRecord& record, const std::string& line) {
    if (record.has("id")) return publish_sample(static_cast<unsigned>(record.number("id")), record);
    const bool taken = link_.publish("test_machine/record", line, Delivery::at_least_once);
    sent_ += static_cast<std::size_t>(taken);
    return taken;
}

bool RecordingReplay::publish_sample(unsigned id, const StreamRecord& record) {
    Node& node = nodes_.at(id);
    const NodeConfiguration& c = node.configuration;
    const double t = record.number("t");
    double change = 0;
    const char* const axes[] = {"ax", "ay", "az"};
    for (int k = 0; k < 3; ++k)
        change = std::max(change, std::abs(record.number(axes[k]) - node.last_force[k]));
    const bool is_first = node.last_time < -1e299;
    if (!is_first && (t - node.last_time < (1 - 1e-6) / c.rate_hz ||
                      (c.strategy == "triggered" && !(change > c.threshold)))) {
        ++withheld_;
        return true;
    }
    SensorPayload p{.channels = 0, .sequence = node.sequence, .time = t, .interval = 0};
    for (unsigned bit = 0; bit < 8; ++bit) {
        SensorPayload one{.channels = static_cast<std::uint8_t>(1u << bit)};
        if (!std::ranges::all_of(one.columns(), [&](const auto& n) { return record.has(n); }))
            continue;
        p.channels = static_cast<std::uint8_t>(p.channels | one.channels);
        for (const auto& name : one.columns())
            p.numbers.push_back(static_cast<float>(record.number(name)));
    }
    if (p.channels == 0) return true;
    if (!link_.publish(fmt::format("smartrock/{}/imu", id), bytes_of(p), Delivery::at_least_once))
        return false;
    ++sent_;
    ++node.sequence;
    node.last_time = t;
    for (int k = 0; k < 3; ++k) node.last_force[k] = record.number(axes[k]);
    return true;
}

} // namespace bris
