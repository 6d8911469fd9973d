#include "scenarios/stream/broker_lines.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/json_members.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t most_kinds = 40; // of faults that are listed apart
constexpr double health_interval = 1;  // s
constexpr double longest_overtime = 1; // s for which messages that give no line are taken
constexpr double same_time = 10;       // s between messages of clocks that are not told apart
constexpr std::string_view of_sensor = "smartrock/", of_machine = "test_machine/record";

/// JSON has no NaN.
std::string json_number(double x) { return std::isfinite(x) ? fmt::format("{:.9g}", x) : "null"; }

} // namespace

std::vector<std::string> BrokerLines::topics() {
    return {"smartrock/+/imu",        "smartrock/+/status",    "smartrock/+/config",
            "smartrock/+/config/ack", std::string(of_machine), BrokerLink::own_topic};
}

BrokerLines::BrokerLines(BrokerLink& link, const std::vector<SensorInfo>& infos) : link_(link) {
    for (const SensorInfo& info : infos) sensors_[info.id];
}

std::optional<Lines::Line> BrokerLines::next(double timeout) {
    const Instant began = this_instant();
    while (ready_.empty()) {
        if (seconds_since(published_) >= health_interval) publish_health();
        const double left = timeout - seconds_since(began);
        const double before = link_.now();
        const auto message = link_.next(std::clamp(left, 0.0, health_interval));
        const bool is_tick = !(link_.now() <= before);
        if (message)
            take(*message);
        else if (interrupted() || left <= 0 || link_.over() || is_tick)
            return {};
        if (ready_.empty() && left < -longest_overtime)
            return {}; // nothing of use, but a lot of it
    }
    Line line = std::move(ready_.front());
    ready_.pop_front();
    return line;
}

void BrokerLines::note(const std::string& kind, const std::string& text) {
    const bool is_new = !notes_.contains(kind);
    auto& [count, first] = notes_[is_new && notes_.size() >= most_kinds ? "others" : kind];
    if (count++ == 0) first = printable(text);
}

void BrokerLines::take(const BrokerMessage& message) {
    const std::string_view topic = message.topic;
    if (topic == BrokerLink::own_topic) return take_news_of_link(message.payload);
    ++messages_;
    if (topic.ends_with("/config") || topic.ends_with("/config/ack")) return; // for the history
    if (topic == of_machine) return take_machine(message);
    const auto slash = topic.rfind('/');
    if (!topic.starts_with(of_sensor) || slash < of_sensor.size())
        return note("topic", fmt::format("unknown topic \"{}\"", beginning_of(message.topic)));
    const auto id = number_of(topic.substr(of_sensor.size(), slash - of_sensor.size()));
    const bool is_id = id && *id >= 0 && *id < 1e9 && std::floor(*id) == *id;
    const auto sensor = is_id ? sensors_.find(static_cast<unsigned>(*id)) : sensors_.end();
    if (sensor == sensors_.end())
        return note("unknown id",
                    fmt::format("{}: expected the id of a file rock_NN.txt, found \"{}\"",
                                beginning_of(message.topic),
                                beginning_of(std::string(
                                    topic.substr(of_sensor.size(), slash - of_sensor.size())))));
    if (topic.substr(slash) == "/status")
        sensor->second.status =
            message.payload.find("offline") == std::string::npos ? "online" : "offline";
    else
        take_payload(sensor->first, sensor->second, message);
}

void BrokerLines::take_news_of_link(const std::string& news) {
    if (news == "began" && messages_ > 0) // of a history: the model was started again
        for (auto& [id, sensor] : sensors_) sensor = {};
    if (news == "session lost")
        note("session", "the broker kept nothing while the connection was broken: what was sent "
                        "meanwhile is lost");
}

void BrokerLines::take_machine(const BrokerMessage& message) {
    std::string text = message.payload;
    std::ranges::replace(text, '\n', ' ');
    std::ranges::replace(text, '\r', ' ');
    try {
        JsonMembers members(text); // what they hold is for who reads the lines
        while (const auto member = members.next())
            require(member->name != "id",
                    "expected no id in a record of the test machine, found one");
    } catch (const InputError& e) {
        return note("test machine", fmt::format("{}: {}", of_machine, e.what()));
    }
    if (message.retained)
        return note("retained",
                    fmt::format("{}: a retained record is of another time", of_machine));
    ++machine_records_;
    ready_.push_back({++lines_, std::move(text), message.arrived, true, message.time});
}

bool BrokerLines::allows(Sensor& sensor, std::size_t samples, double now) const {
    const double since = std::max(0.0, now - std::exchange(sensor.filled, now));
    sensor.allowance = std::min(most_samples * burst, sensor.allowance + most_samples * since);
    if (sensor.allowance < static_cast<double>(samples)) return false;
    sensor.allowance -= static_cast<double>(samples);
    return true;
}

void BrokerLines::take_payload(unsigned id, Sensor& sensor, const BrokerMessage& message) {
    if (message.retained)
        return note(fmt::format("retained {}", id),
                    fmt::format("{}: a retained record is of another time", message.topic));
    SensorPayload p;
    try {
        p = parse_sensor_payload(message.payload);
    } catch (const InputError& e) {
        ++sensor.unreadable;
        return note("payload", fmt::format("{}: {}", message.topic, e.what()));
    }
    if (!allows(sensor, p.samples(), message.time)) {
        if (sensor.over_rate++ == 0)
            note(fmt::format("rate {}", id),
                 fmt::format("{}: expected at most {:g} samples per second; more are dropped",
                             message.topic, most_samples));
        return;
    }
    take_samples(id, sensor, std::move(p), message);
}

void BrokerLines::take_samples(unsigned id, Sensor& sensor, SensorPayload p,
                               const BrokerMessage& message) {
    const auto gaps = sensor.track.counters().gaps;
    const auto missing = sensor.track.counters().missing;
    const auto verdict = sensor.track.take({p.sequence, static_cast<std::uint32_t>(p.samples()),
                                            p.time, static_cast<double>(p.interval),
                                            std::hash<std::string>{}(message.payload)});
    if (sensor.track.counters().gaps > gaps)
        note(fmt::format("gap {}", id),
             fmt::format("{}: {} samples are missing after {:.6g} s; some may come late",
                         message.topic, sensor.track.counters().missing - missing,
                         sensor.last_time));
    if (waits_or_is_of_another(id, sensor, p, verdict, message.topic)) return;
    if (verdict == SequenceTrack::Verdict::adopted) {
        note(fmt::format("restart {}", id),
             fmt::format(
                 "{}: the sequence or the clock began again: sequence {}, time {:.6g} s after "
                 "{:.6g} s",
                 message.topic, p.sequence, p.time, sensor.last_time));
        for (const SensorPayload& before : std::exchange(sensor.held, {}))
            add(id, sensor, before, message);
    }
    if (verdict == SequenceTrack::Verdict::accepted || verdict == SequenceTrack::Verdict::adopted)
        sensor.last_time =
            p.time + static_cast<double>(p.samples() - 1) * static_cast<double>(p.interval);
    add(id, sensor, p, message);
}

/// Whether a message does not go on now. Where its sequence numbers are others while the time goes
/// on, times cannot tell whether the sensor counts anew or there is a second one with its id.
bool BrokerLines::waits_or_is_of_another(unsigned id, Sensor& sensor, const SensorPayload& p,
                                         SequenceTrack::Verdict verdict, const std::string& topic) {
    using enum SequenceTrack::Verdict;
    const bool is_other = verdict == contradiction || verdict == rival;
    if (is_other)
        note(fmt::format("two sensors {}", id),
             fmt::format("{}: expected one sensor with this id, found two: sequence {} at {:.6g} s "
                         "next to {:.6g} s; the first is used",
                         topic, p.sequence, p.time, sensor.last_time));
    if (is_other || verdict == held_anew) sensor.held.clear();
    if (!(std::abs(p.time - sensor.last_time) <= same_time)) return false; // the gate can tell
    if (verdict == held || verdict == held_anew) sensor.held.push_back(p);
    return is_other || verdict == held || verdict == held_anew;
}

void BrokerLines::add(unsigned id, Sensor& sensor, const SensorPayload& p,
                      const BrokerMessage& message) {
    if ((p.channels & 0x80) != 0) sensor.battery = static_cast<double>(p.numbers.back());
    if (!std::ranges::all_of(p.numbers, [](float x) { return std::isfinite(x); }))
        note(fmt::format("not finite {}", id),
             fmt::format("smartrock/{}/imu: expected numbers, found some that are not finite at "
                         "{:.6g} s",
                         id, p.time));
    for (std::string& line : stream_lines(id, p))
        ready_.push_back({++lines_, std::move(line), message.arrived, true, message.time});
}

void BrokerLines::publish_health() {
    published_ = this_instant();
    link_.publish("bris/health", health(), BrokerLink::Delivery::retained);
}

std::string BrokerLines::health() const {
    const BrokerCounters b = link_.counters();
    std::string text = fmt::format(
        "{{\"time\": {:.3f}, \"messages\": {}, \"machine_records\": {}, "
        "\"breaks\": {}, \"lost_sessions\": {}, \"dropped\": {}, \"sensors\": [",
        arrival_now(), messages_, machine_records_, b.breaks, b.lost_sessions, b.dropped);
    bool first = true;
    for (const auto& [id, s] : sensors_) {
        const auto& c = s.track.counters();
        text += fmt::format(
            "{}{{\"id\": {}, \"status\": \"{}\", \"samples\": {}, \"missing\": {}, \"gaps\": {}, "
            "\"late\": {}, \"duplicates\": {}, \"restarts\": {}, \"refused\": {}, \"battery\": {}, "
            "\"t\": {}}}",
            first ? "" : ", ", id, s.status, c.samples, c.missing, c.gaps, c.late, c.duplicates,
            c.restarts, c.rivals + c.contradictions + c.forgotten + s.over_rate + s.unreadable,
            json_number(s.battery), json_number(s.last_time));
        first = false;
    }
    return text + "]}";
}

std::string BrokerLines::report() const {
    const BrokerCounters b = link_.counters();
    std::string text = fmt::format(
        "broker: {} messages, {} breaks of the connection, {} of them without a session, {} "
        "dropped from a full queue, {} too large, {} published, {} not published, {} publications "
        "refused\n",
        messages_, b.breaks, b.lost_sessions, b.dropped, b.too_large, b.published, b.unpublished,
        b.refused);
    for (const auto& [id, s] : sensors_) {
        const auto& c = s.track.counters();
        text += fmt::format(
            "sensor {}: {} samples, {} missing in {} gaps, {} messages late, {} again, {} "
            "restarts, {} pauses, {} of another sensor, {} unreadable, {} above the rate, {} "
            "forgotten\n",
            id, c.samples, c.missing, c.gaps, c.late, c.duplicates, c.restarts, c.pauses,
            c.rivals + c.contradictions, s.unreadable, s.over_rate, c.forgotten);
    }
    for (const auto& [kind, what] : notes_)
        text += fmt::format("{} time{}: {}\n", what.first, what.first == 1 ? "" : "s", what.second);
    return text;
}

} // namespace bris
