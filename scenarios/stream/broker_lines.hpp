#pragma once

#include "engine/io/broker_link.hpp"
#include "engine/io/line_source.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/stream/sensor_payload.hpp"
#include "scenarios/stream/sequence_track.hpp"

#include <deque>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Records of SmartRocks and of a test machine that a broker delivers, as the lines of a stream.
/// Topics: smartrock/ID/imu (SensorPayload), smartrock/ID/status (text, "offline" as last will),
/// test_machine/record (one JSON object of numbers). Payloads that cannot be used, gaps,
/// duplicates, restarts, unknown ids and two sensors with one id are counted and named, and a
/// sensor that sends too much is limited; the state of all sensors is published as bris/health. The
/// order and the times of records are judged by the Gate behind these lines, which get all of them;
/// but of two sensors with one id and the same time, which only their sequence numbers tell from
/// each other, the second one is left out.
/// The settings of sensors, smartrock/ID/config, and their acknowledgements pass as well, so that a
/// history has them. What becomes of a message depends on the messages alone and their times of
/// arrival: a history gives the same lines again.
class BrokerLines : public Lines {
public:
    /// Samples per second of one sensor that are taken; more are dropped and counted.
    static constexpr double most_samples = 5000;
    /// s for which a sensor may send more, as after a break.
    static constexpr double burst = 20;

    /// The topics to subscribe.
    static std::vector<std::string> topics();
    /// The link has to live longer. `infos`: the sensors that are known.
    BrokerLines(BrokerLink& link, const std::vector<SensorInfo>& infos);
    std::optional<Line> next(double timeout) override;
    bool over() const override { return ready_.empty() && link_.over(); }
    double now() const override { return link_.now(); }
    bool is_repeating() const override {
        return ready_.empty() ? link_.is_repeating() : ready_.front().arrived == Instant{};
    }

    /// Makes lines of a message.
    void take(const BrokerMessage& message);
    /// State of the sensors and of the connection, a JSON object.
    std::string health() const;
    /// What was lost or refused, a line for each sensor and kind.
    std::string report() const;

private:
    struct Sensor {
        SequenceTrack track;
        std::vector<SensorPayload> held;             // of other sequence numbers at the same time
        double allowance = most_samples * burst;     // samples
        double filled = 0;                           // s, time of the last message
        std::uint64_t over_rate = 0, unreadable = 0; // messages
        double battery = std::numeric_limits<double>::quiet_NaN(), last_time = battery;
        std::string status = "unknown";
    };
    void take_payload(unsigned id, Sensor& sensor, const BrokerMessage& message);
    void take_samples(unsigned id, Sensor& sensor, SensorPayload p, const BrokerMessage& message);
    bool waits_or_is_of_another(unsigned id, Sensor& sensor, const SensorPayload& p,
                                SequenceTrack::Verdict verdict, const std::string& topic);
    void take_machine(const BrokerMessage& message);
    bool allows(Sensor& sensor, std::size_t samples, double now) const;
    void take_news_of_link(const std::string& news);
    void add(unsigned id, Sensor& sensor, const SensorPayload& payload,
             const BrokerMessage& message);
    void note(const std::string& kind, const std::string& text);
    void publish_health();

    BrokerLink& link_;
    std::map<unsigned, Sensor> sensors_;
    std::deque<Line> ready_;
    std::uint64_t lines_ = 0, messages_ = 0, machine_records_ = 0;
    std::map<std::string, std::pair<std::uint64_t, std::string>> notes_;
    Instant published_ = {}; // of health: at once, and then every second
};

} // namespace bris
