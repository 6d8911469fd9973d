#pragma once

#include "engine/io/broker_link.hpp"
#include "scenarios/stream/record_stream.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Settings that an engineer gives a sensor.
struct NodeConfiguration {
    std::uint64_t revision = 0;
    double rate_hz = 5000;               ///< samples above this rate are not sent
    std::string strategy = "continuous"; ///< or "triggered": sent if above the threshold
    double threshold = 0; ///< m/s2, change of the specific force since the last sample
};

/// Reads smartrock/ID/config: a JSON object with revision, rate_hz (0.01 to 5000), strategy and
/// threshold (0 to 1000). Throws InputError.
NodeConfiguration parse_configuration(const std::string& json);

/// The sensors and the machine of a recorded test as a broker sees them: publishes the lines of a
/// stream at the speed of their times, and obeys and acknowledges the configuration of each sensor.
class RecordingReplay {
public:
    static std::vector<std::string> topics() { return {"smartrock/+/config"}; }
    /// The link, with a subscription of the topics, has to live longer. `speed` > 0, relative to
    /// the t.
    RecordingReplay(BrokerLink& link, const std::vector<std::string>& lines, double speed);
    /// Publishes what is due, with confirmation, as far as the link takes it, and obeys what has
    /// come. Returns false when all is sent.
    bool advance();
    std::size_t sent() const { return sent_; }
    std::size_t withheld() const { return withheld_; } ///< by the configurations

private:
    void obey(const BrokerMessage& message);
    bool publish(const StreamRecord& record, const std::string& line);
    bool publish_sample(unsigned id, const StreamRecord& record);

    struct Node {
        NodeConfiguration configuration;
        std::uint32_t sequence = 0;
        double last_time = -1e300; ///< s, of the last sample sent
        double last_force[3] = {0, 0, 0};
    };
    BrokerLink& link_;
    std::vector<std::pair<StreamRecord, std::string>> records_;
    double speed_, first_t_ = 0;
    Instant began_ = this_instant();
    std::size_t next_ = 0, sent_ = 0, withheld_ = 0;
    std::map<unsigned, Node> nodes_;
};

} // namespace bris
