#pragma once

#include "scenarios/ensemble/live_model.hpp"
#include "scenarios/monitoring/publisher.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <vector>

namespace bris {

// What the model of a live triaxial test gives to the publisher.

/// Nothing is judged yet, whatever a run before has published.
void publish_unknown(BrokerLink& link, const std::string& run,
                     const std::vector<SensorInfo>& infos);
/// Before the first record: shapes and poses of all rocks, and alarms that know nothing yet.
void publish_start(Publisher& publisher, const World& world, const BodyFrame& frame,
                   const ModelRun& model, const std::vector<SensorInfo>& infos);
/// The last stage. `latency`: s, from the arrival of the machine's record to the answer; NaN: there
/// was no record.
void publish_stage(Publisher& publisher, const BodyFrame& frame, const LiveModel& model,
                   const RecordedTest& so_far, double latency);

/// Whether model and test disagree.
PublishedAlarm agreement_alarm(const FusedStress& fused, double strain);
/// Whether a sensor is left out. With fewer records than quality control needs: unknown.
PublishedAlarm sensor_alarm(const SensorInfo& info, const RecordedTest& so_far, double strain);

/// All rocks as they are in the last stage of a model. `first`: the frame at its start; membrane
/// and velocities stay as they are there.
BodyFrame frame_of_model(const BodyFrame& first, const ModelRun& model);

} // namespace bris
