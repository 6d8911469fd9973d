#pragma once

#include "scenarios/assimilation/live_model.hpp"
#include "scenarios/monitoring/state_publisher.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <vector>

namespace bris {

/// Publishes what the model of a live triaxial test finds.
class TestPublisher {
public:
    /// The link and the sensors have to live longer.
    TestPublisher(BrokerLink& link, const std::vector<SensorInfo>& infos)
        : publisher_(link), infos_(infos) {}
    /// Shapes and poses of all rocks at the start; the model tells which are those of sensors.
    void publish_scene(const World& world, const BodyFrame& frame, const ModelRun& model);
    /// Poses of all rocks, curves with their estimates, and sensors that are left out. `latency`:
    /// s, from the machine's record to the analysis; NaN: there was no record.
    void publish_stage(const BodyFrame& frame, const LiveModel& model, const RecordedTest& so_far,
                       double latency);

private:
    StatePublisher publisher_;
    const std::vector<SensorInfo>& infos_;
};

/// All rocks as they are in the last stage of a model. `first`: the frame at its start; membrane
/// and velocities stay as they are there.
BodyFrame frame_of_model(const BodyFrame& first, const ModelRun& model);

} // namespace bris
