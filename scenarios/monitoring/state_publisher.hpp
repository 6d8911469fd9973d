#pragma once

#include "engine/io/broker_link.hpp"
#include "engine/named_value.hpp"
#include "engine/world.hpp"
#include "systems/output/frames.hpp"

#include <map>
#include <string>
#include <vector>

namespace bris {

/// An alarm of one sensor, or its end.
struct SensorAlarm {
    unsigned sensor = 0;
    bool active = true;
    std::string verdict, reason;
    double time = 0; ///< s, or the axial strain of a triaxial test
};

/// Publishes what a model finds, for pages and other programs that listen to the broker:
///     bris/scene   JSON, retained: spheres of each shape (over its bounding radius); of each body
///                  its id, shape, bounding radius (m) and sensor (0: none)
///     bris/poses/K binary, little-endian, retained: part K of the poses: u8 version (2), u8, u16,
///                  u32 bodies of the scene, f64 time, u32 first body of the part, then for each of
///                  its bodies f32 x y z (m) and qw qx qy qz. A part has 4 kB at most: mosquitto
///                  sends a larger message over websockets in pieces of this size, ten in a second.
///     bris/state   JSON: numbers by name; the same in a replay
///     bris/timing  JSON: numbers by name that come from clocks
///     smartrock/ID/pose   JSON: t, position (m), attitude (w x y z)
///     smartrock/ID/alarm  JSON, retained: active, verdict, reason, t
/// The scene is published before poses; they have the same bodies in the same order.
class StatePublisher {
public:
    /// The link has to live longer.
    explicit StatePublisher(BrokerLink& link) : link_(link) {}
    /// `sensors`: id of the sensor in a body, by the id of the body.
    void publish_scene(const World& world, const BodyFrame& frame,
                       const std::map<std::int64_t, unsigned>& sensors, const std::string& title);
    void publish_poses(const BodyFrame& frame);
    void publish_state(const std::vector<NamedValue>& numbers) { publish("bris/state", numbers); }
    /// Numbers that are others in a replay, since they come from clocks.
    void publish_timing(const std::vector<NamedValue>& numbers) { publish("bris/timing", numbers); }
    /// Publishes the alarm if it is not what was published last of this sensor.
    void publish(const SensorAlarm& alarm);

private:
    void publish(const std::string& topic, const std::vector<NamedValue>& numbers);

    BrokerLink& link_;
    std::map<std::int64_t, unsigned> sensors_;
    std::map<unsigned, std::string> alarms_; // as published last, without the time
};

/// bris/scene and the parts of bris/poses, for tests and other publishers.
std::string scene_json(const World& world, const BodyFrame& frame,
                       const std::map<std::int64_t, unsigned>& sensors, const std::string& title);
std::vector<std::string> parts_of_poses(const BodyFrame& frame);

} // namespace bris
