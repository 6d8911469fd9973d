#include "scenarios/specimens/recorded_motion.hpp"

#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "scenarios/specimens/scene.hpp"

namespace bris {

Recording recording_of(const RecordingImu& recorder, unsigned id, const Vec3& position,
                       const Quat& attitude) {
    const ImuModel& m = recorder.imu.model();
    Recording r;
    r.info.id = id;
    r.info.set_pose(position, attitude);
    r.info.sampling_rate = m.rate;
    if (m.force_range > 0) r.info.force_range = m.force_range; // without limit the default stays
    if (m.rate_range > 0) r.info.rate_range = m.rate_range;
    r.info.force_noise = m.noise.force;
    r.info.rate_noise = m.noise.rate;
    r.info.force_bias = m.force_bias;
    r.info.rate_bias = m.rate_bias;
    r.info.arm_x = m.arm.x();
    r.info.arm_y = m.arm.y();
    r.info.arm_z = m.arm.z();
    r.info.mounting_w = m.mounting.w();
    r.info.mounting_x = m.mounting.x();
    r.info.mounting_y = m.mounting.y();
    r.info.mounting_z = m.mounting.z();
    for (const ImuSample& s : recorder.samples) {
        if (s.lost) continue;
        r.time.push_back(s.time);
        r.sequence.push_back(s.sequence);
        r.force.push_back(m.mounting * s.force); // body axes
        r.rate.push_back(m.mounting * s.rate);
        r.flags.push_back(s.saturated ? 1 : 0);
    }
    return r;
}

namespace {

/// Poses of the bodies with inertial recorders, on all ranks.
std::vector<Pose> poses_of_recorders(const World& world) {
    const auto& list = world.resource<InertialRecorders>().list;
    const OverRanks ranks(world);
    const RowIndex row_of(world.column<Bodies, BodyId>());
    std::vector<double> numbers;
    for (const InertialRecorder& recorder : list) {
        const Row row = row_of[recorder.body];
        const bool here = row != no_row && ranks.counts(row);
        const Vec3 x = here ? world.column<Bodies, Position>()[row] : Vec3(Vec3::Zero());
        const Quat q = here ? world.column<Bodies, Orientation>()[row] : Quat(0, 0, 0, 0);
        numbers.insert(numbers.end(), {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z()});
    }
    if (ranks.is_divided()) Ranks::sum(std::span(numbers)); // one rank has each, others zeros
    std::vector<Pose> poses;
    for (auto n = numbers.begin(); n != numbers.end(); n += 7)
        poses.push_back({Vec3(n[0], n[1], n[2]), Quat(n[3], n[4], n[5], n[6])});
    return poses;
}

} // namespace

std::vector<Recording> recordings_of(const World& world, RecordingImu InertialRecorder::*by) {
    const std::vector<Pose> poses = poses_of_recorders(world);
    std::vector<Recording> recordings;
    for (const InertialRecorder& recorder : world.resource<InertialRecorders>().list) {
        const Pose& pose = poses[recordings.size()];
        recordings.push_back(recording_of(recorder.*by,
                                          static_cast<unsigned>(recordings.size() + 1),
                                          pose.position, pose.orientation));
    }
    return recordings;
}

std::vector<Recording> with_poses(std::vector<Recording> recordings,
                                  const SpecimenSettings& specimen,
                                  const std::vector<SmartRockPose>& poses) {
    const Vec3 size(specimen.radius, specimen.radius, specimen.height);
    for (std::size_t k = 0; k < recordings.size(); ++k)
        recordings[k].info.set_placed(poses[k].position.cwiseQuotient(size), poses[k].orientation);
    return recordings;
}

} // namespace bris
