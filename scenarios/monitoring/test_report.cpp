#include "scenarios/monitoring/test_report.hpp"

#include "engine/signal/attitude.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace bris {

namespace {

/// Sensor in each rock that has one, by the id of its body.
std::map<std::int64_t, unsigned> sensors_in(const ModelRun& model,
                                            const std::vector<SensorInfo>& infos) {
    std::map<std::int64_t, unsigned> sensors;
    for (std::size_t k = 0; k < model.sensors; ++k)
        sensors[static_cast<std::int64_t>(model.rocks[k])] = infos[k].id;
    return sensors;
}

/// The numbers of the last stage.
std::vector<ValueOf<NumbersOf::test>> numbers_of_stage(const LiveModel& model,
                                                       const RecordedTest& so_far) {
    const auto now = [&](const Quantity& q) { return model.state().curves[q].back(); };
    const FusedStress& fused = model.fused();
    const double strain = now(quantity::axial_strain),
                 half_stage = 0.5 * (model.next_strain() - strain);
    const auto& strains = so_far.curves[quantity::axial_strain];
    const auto row = std::ranges::find_if(
        strains, [&](double other) { return std::abs(other - strain) <= half_stage; });
    const auto measured = [&](const Quantity& q) {
        return row == strains.end()
                   ? FusedStress::unknown
                   : so_far.curves[q][static_cast<std::size_t>(row - strains.begin())];
    };
    const Gaussian estimate = model.estimate();
    const RockParameters mean = mean_of(estimate);
    const Matrix covariance = estimate.covariance();
    return {{"axial_strain", strain},
            {"measured_q_Pa", measured(quantity::deviatoric_stress)},
            {"model_q_Pa", now(quantity::deviatoric_stress)},
            {"fused_q_Pa", fused.fused},
            {"fused_q_half_width_Pa", fused.half_width},
            {"specimen_factor", fused.fused / fused.model},
            {"measured_volumetric_strain", measured(quantity::volumetric_strain)},
            {"model_volumetric_strain", now(quantity::volumetric_strain)},
            {"learned_friction", mean.friction},
            {"learned_friction_deviation", mean.friction * std::sqrt(covariance(0, 0))},
            {"learned_stiffness_ratio", mean.stiffness},
            {"learned_stiffness_ratio_deviation", mean.stiffness * std::sqrt(covariance(1, 1))}};
}

} // namespace

void publish_unknown(BrokerLink& link, const std::string& run,
                     const std::vector<SensorInfo>& infos) {
    Publisher publisher(link, run);
    for (const SensorInfo& info : infos) publisher.publish_alarm(info.id, PublishedAlarm{});
    publisher.publish_alarm("agreement", PublishedAlarm{});
}

void publish_start(Publisher& publisher, const World& world, const BodyFrame& frame,
                   const ModelRun& model, const std::vector<SensorInfo>& infos) {
    for (const SensorInfo& info : infos) publisher.publish_alarm(info.id, PublishedAlarm{});
    publisher.publish_alarm("agreement", PublishedAlarm{});
    publisher.publish_scene(world, frame, sensors_in(model, infos),
                            "Triaxial test with SmartRocks");
}

void publish_stage(Publisher& publisher, const BodyFrame& frame, const LiveModel& model,
                   const RecordedTest& so_far, double latency) {
    publisher.publish_poses(frame);
    publisher.publish_test(numbers_of_stage(model, so_far));
    publisher.publish_timing({{"axial_strain", model.strain()}, {"latency_s", latency}});
    publisher.publish_alarm("agreement", agreement_alarm(model.fused(), model.strain()));
    for (const Recording& r : so_far.recordings)
        publisher.publish_alarm(r.info.id, sensor_alarm(r.info, so_far, model.strain()));
}

PublishedAlarm agreement_alarm(const FusedStress& fused, double strain) {
    switch (fused.agreement) {
    case FusedStress::Agreement::agrees:
        return {AlarmState::clear, "model and test agree", fused.reason, strain};
    case FusedStress::Agreement::disagrees:
        return {AlarmState::active, "the model disagrees with the test", fused.reason, strain};
    case FusedStress::Agreement::unknown:
        break;
    }
    return {AlarmState::unknown, "model and test are not compared", fused.reason, strain};
}

PublishedAlarm sensor_alarm(const SensorInfo& info, const RecordedTest& so_far, double strain) {
    PublishedAlarm alarm{AlarmState::clear, "in use", "", strain};
    for (const Finding& f : so_far.findings) {
        if (f.sensor != info.id || f.kind != Finding::Kind::refusal) continue;
        if (f.check == "length") // as before its first records
            return {AlarmState::unknown, "not enough data", f.text, strain};
        alarm = {AlarmState::active, "left out", f.check + ": " + f.text, strain};
    }
    return alarm;
}

BodyFrame frame_of_model(const BodyFrame& first, const ModelRun& model) {
    std::map<std::int64_t, std::size_t> index_of;
    for (std::size_t k = 0; k < model.rocks.size(); ++k)
        index_of[static_cast<std::int64_t>(model.rocks[k])] = k;
    BodyFrame frame = first;
    frame.time = model.curves[quantity::axial_strain].back();
    for (std::size_t b = 0; b < frame.ids.size(); ++b) {
        const auto found = index_of.find(frame.ids[b]);
        if (found == index_of.end()) continue;
        const RockPose& start = model.start[found->second];
        frame.positions[b] = start.position + model.displacement.back()[found->second];
        const Quat q = exponential_map(model.rotation.back()[found->second]) * start.orientation;
        const double numbers[] = {q.w(), q.x(), q.y(), q.z()};
        for (std::size_t i = 0; i < 4; ++i)
            frame.orientations[4 * b + i] = static_cast<float>(numbers[i]);
    }
    return frame;
}

} // namespace bris
