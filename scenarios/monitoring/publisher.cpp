#include "scenarios/monitoring/publisher.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace bris {

namespace {

using Delivery = BrokerLink::Delivery;

template <class T>
void append(std::string& bytes, T number) {
    std::array<char, sizeof number> raw;
    std::memcpy(raw.data(), &number, sizeof number);
    bytes.append(raw.data(), raw.size());
}

/// Attitude of a body of a frame: w x y z.
std::array<float, 4> attitude_in(const BodyFrame& frame, std::size_t body) {
    if (frame.orientations.empty()) return {1, 0, 0, 0};
    const float* q = &frame.orientations[4 * body];
    return {q[0], q[1], q[2], q[3]};
}

std::int64_t shape_in(const BodyFrame& frame, std::size_t body) {
    return frame.shapes.empty() ? 0 : frame.shapes[body];
}

/// JSON has no NaN.
nlohmann::json number(double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(); }

template <NumbersOf Message>
std::string json_of(const std::vector<ValueOf<Message>>& numbers) {
    nlohmann::json all = nlohmann::json::object();
    for (const auto& n : numbers) all[std::string(n.name.text)] = number(n.value);
    return all.dump();
}

const char* text_of(AlarmState state) {
    return state == AlarmState::active  ? "active"
           : state == AlarmState::clear ? "clear"
                                        : "unknown";
}

} // namespace

Publisher::Publisher(BrokerLink& link, std::string run) : link_(link), run_(std::move(run)) {
    link_.publish("bris/numbers", published_table(), Delivery::retained);
}

std::string scene_json(const World& world, const BodyFrame& frame,
                       const std::map<std::int64_t, unsigned>& sensors, const std::string& title) {
    std::map<std::int64_t, std::size_t> first; // body of each shape
    for (std::size_t b = 0; b < frame.ids.size(); ++b) first.emplace(shape_in(frame, b), b);
    std::map<std::int64_t, std::int64_t> shape_of; // by body, of the first ones alone
    for (const auto& [shape, body] : first) shape_of[frame.ids[body]] = shape;
    nlohmann::json shapes = nlohmann::json::object(), bodies = nlohmann::json::array();
    const auto rounded = [](double x) { return std::round(1e5 * x) / 1e5; };
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    for (std::size_t s = 0; s < ball.size(); ++s) {
        const auto found = shape_of.find(static_cast<std::int64_t>(parent[s]));
        if (found == shape_of.end()) continue;
        const auto radius = static_cast<double>(frame.radii[first.at(found->second)]);
        const Vec3 c = ball[s].centre / radius;
        shapes[std::to_string(found->second)].push_back(
            {rounded(c.x()), rounded(c.y()), rounded(c.z()), rounded(ball[s].radius / radius)});
    }
    for (std::size_t b = 0; b < frame.ids.size(); ++b) {
        const auto sensor = sensors.find(frame.ids[b]);
        bodies.push_back({frame.ids[b], shape_in(frame, b),
                          std::round(1e7 * static_cast<double>(frame.radii[b])) / 1e7,
                          sensor == sensors.end() ? 0u : sensor->second});
    }
    return nlohmann::json{{"title", title}, {"shapes", shapes}, {"bodies", bodies}}.dump();
}

std::vector<std::string> parts_of_poses(const BodyFrame& frame) {
    constexpr std::size_t bodies_of_part = 140; // below 4 kB
    std::vector<std::string> parts;
    for (std::size_t b = 0; b < frame.ids.size(); ++b) {
        if (b % bodies_of_part == 0) {
            std::string& head = parts.emplace_back();
            append(head, std::uint32_t{2}); // version, and three bytes that are not used
            append(head, static_cast<std::uint32_t>(frame.ids.size()));
            append(head, frame.time);
            append(head, static_cast<std::uint32_t>(b));
        }
        for (int k = 0; k < 3; ++k) append(parts.back(), static_cast<float>(frame.positions[b][k]));
        for (const float part : attitude_in(frame, b)) append(parts.back(), part);
    }
    return parts;
}

void Publisher::publish_scene(const World& world, const BodyFrame& frame,
                              const std::map<std::int64_t, unsigned>& sensors,
                              const std::string& title) {
    sensors_ = sensors;
    link_.publish("bris/scene", scene_json(world, frame, sensors, title), Delivery::retained);
    publish_poses(frame);
}

void Publisher::publish_poses(const BodyFrame& frame) {
    const auto parts = parts_of_poses(frame);
    for (std::size_t k = 0; k < parts.size(); ++k)
        link_.publish(fmt::format("bris/poses/{}", k), parts[k], Delivery::retained);
    for (std::size_t b = 0; b < frame.ids.size(); ++b) {
        const auto sensor = sensors_.find(frame.ids[b]);
        if (sensor == sensors_.end()) continue;
        const Vec3& p = frame.positions[b];
        const auto q = attitude_in(frame, b);
        link_.publish(
            fmt::format("smartrock/{}/pose", sensor->second),
            nlohmann::json{{"t", frame.time}, {"position", {p.x(), p.y(), p.z()}}, {"attitude", q}}
                .dump(),
            Delivery::once_at_most);
    }
}

void Publisher::publish_test(const std::vector<ValueOf<NumbersOf::test>>& numbers) {
    link_.publish("bris/state", json_of(numbers), Delivery::once_at_most);
}

void Publisher::publish_timing(const std::vector<ValueOf<NumbersOf::timing>>& numbers) {
    link_.publish("bris/timing", json_of(numbers), Delivery::once_at_most);
}

void Publisher::publish_sensor(unsigned id,
                               const std::vector<ValueOf<NumbersOf::sensor>>& numbers) {
    link_.publish(fmt::format("bris/sensor/{}", id), json_of(numbers), Delivery::once_at_most);
}

void Publisher::publish_alarm(unsigned sensor, const PublishedAlarm& alarm) {
    publish_alarm_on(fmt::format("smartrock/{}/alarm", sensor), alarm);
}

void Publisher::publish_alarm(const std::string& name, const PublishedAlarm& alarm) {
    publish_alarm_on("bris/alarm/" + name, alarm);
}

void Publisher::publish_alarm_on(const std::string& topic, const PublishedAlarm& alarm) {
    const std::string text =
        fmt::format("{} {} {}", text_of(alarm.state), alarm.verdict, alarm.reason);
    if (std::exchange(alarms_[topic], text) == text) return;
    link_.publish(topic,
                  nlohmann::json{{"state", text_of(alarm.state)},
                                 {"verdict", alarm.verdict},
                                 {"reason", alarm.reason},
                                 {"t", number(alarm.time)},
                                 {"run", run_}}
                      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                  Delivery::retained);
}

} // namespace bris
