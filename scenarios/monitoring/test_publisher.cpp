#include "scenarios/monitoring/test_publisher.hpp"

#include "engine/signal/attitude.hpp"
#include "scenarios/assimilation/learning_results.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace bris {

void TestPublisher::publish_scene(const World& world, const BodyFrame& frame,
                                  const ModelRun& model) {
    std::map<std::int64_t, unsigned> sensors;
    for (std::size_t k = 0; k < model.sensors; ++k)
        sensors[static_cast<std::int64_t>(model.rocks[k])] = infos_[k].id;
    publisher_.publish_scene(world, frame, sensors, "Triaxial test with SmartRocks");
}

void TestPublisher::publish_stage(const BodyFrame& frame, const LiveModel& model,
                                  const RecordedTest& so_far, double latency) {
    publisher_.publish_poses(frame);
    const auto& points = model.state().points;
    const TriaxialPoint& now = points.back();
    std::vector<NamedValue> numbers{{"axial_strain", now.axial_strain},
                                    {"q_Pa", now.deviatoric_stress},
                                    {"volumetric_strain", now.volumetric_strain}};
    for (const NamedValue& v : describe(model.estimate())) numbers.push_back(v);
    const double half_stage = 0.5 * (model.next_strain() - now.axial_strain);
    const auto measured = std::ranges::find_if(so_far.measured, [&](const TriaxialPoint& p) {
        return p.axial_strain >= now.axial_strain - half_stage;
    });
    if (measured != so_far.measured.end()) {
        numbers.push_back({"measured_q_Pa", measured->deviatoric_stress});
        numbers.push_back({"measured_volumetric_strain", measured->volumetric_strain});
    }
    publisher_.publish_state(numbers);
    publisher_.publish_timing({{"axial_strain", now.axial_strain}, {"latency_s", latency}});
    for (const SensorInfo& info : infos_) {
        SensorAlarm alarm{info.id, false, "in use", "", now.axial_strain};
        for (const Finding& f : so_far.findings)
            if (f.sensor == info.id && f.kind == Finding::Kind::refusal)
                alarm = {info.id, true, "left out", f.check + ": " + f.text, now.axial_strain};
        publisher_.publish(alarm);
    }
}

BodyFrame frame_of_model(const BodyFrame& first, const ModelRun& model) {
    std::map<std::int64_t, std::size_t> index_of;
    for (std::size_t k = 0; k < model.rocks.size(); ++k)
        index_of[static_cast<std::int64_t>(model.rocks[k])] = k;
    BodyFrame frame = first;
    frame.time = model.points.back().axial_strain;
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
