#pragma once

#include "engine/io/broker_link.hpp"
#include "engine/world.hpp"
#include "scenarios/monitoring/published_numbers.hpp"
#include "systems/output/frames.hpp"

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Whether something is wrong. `unknown`: it was not judged, or could not be; never an all-clear.
enum class AlarmState { active, clear, unknown };

struct PublishedAlarm {
    AlarmState state = AlarmState::unknown;
    std::string verdict = "not judged yet", reason = {};
    double time = std::numeric_limits<double>::quiet_NaN(); ///< s, or axial strain of a test
};

/// Publishes what a model finds, for pages and other programs that listen to the broker:
///     bris/scene   JSON, retained: spheres of each shape (over its bounding radius); of each body
///                  its id, shape, bounding radius (m) and sensor (0: none)
///     bris/poses/K binary, little-endian, retained: part K of the poses: u8 version (2), u8, u16,
///                  u32 bodies of the scene, f64 time, u32 first body of the part, then for each of
///                  its bodies f32 x y z (m) and qw qx qy qz. A part has 4 kB at most: mosquitto
///                  sends a larger message over websockets in pieces of this size, ten in a second.
///     bris/numbers JSON, retained: the table of published numbers and their curves
///     bris/state, bris/timing, bris/sensor/ID   JSON: those numbers by name
///     smartrock/ID/pose   JSON: t, position (m), attitude (w x y z)
///     smartrock/ID/alarm, bris/alarm/NAME   JSON, retained: state (active, clear, unknown),
///                  verdict, reason, t, run (whose signs of life say whether it still holds)
/// The scene is published before poses; they have the same bodies in the same order.
class Publisher {
public:
    /// The link has to live longer. `run`: name of the run in its signs of life. Publishes the
    /// table of numbers.
    Publisher(BrokerLink& link, std::string run);
    /// `sensors`: id of the sensor in a body, by the id of the body.
    void publish_scene(const World& world, const BodyFrame& frame,
                       const std::map<std::int64_t, unsigned>& sensors, const std::string& title);
    void publish_poses(const BodyFrame& frame);
    void publish_test(const std::vector<ValueOf<NumbersOf::test>>& numbers);
    void publish_timing(const std::vector<ValueOf<NumbersOf::timing>>& numbers);
    void publish_sensor(unsigned id, const std::vector<ValueOf<NumbersOf::sensor>>& numbers);
    /// Publish an alarm of a sensor, or of another name, if it is not what was published last.
    void publish_alarm(unsigned sensor, const PublishedAlarm& alarm);
    void publish_alarm(const std::string& name, const PublishedAlarm& alarm);

private:
    void publish_alarm_on(const std::string& topic, const PublishedAlarm& alarm);

    BrokerLink& link_;
    std::string run_;
    std::map<std::int64_t, unsigned> sensors_;
    std::map<std::string, std::string> alarms_; // by topic, as published last, without the time
};

/// bris/scene and the parts of bris/poses, for tests and other publishers.
std::string scene_json(const World& world, const BodyFrame& frame,
                       const std::map<std::int64_t, unsigned>& sensors, const std::string& title);
std::vector<std::string> parts_of_poses(const BodyFrame& frame);

} // namespace bris
