#pragma once

#include "scenarios/sensors/recording.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "systems/recorder/record_motion.hpp"

#include <string>
#include <vector>

namespace bris {

/// What a device in a simulation has recorded, as a recording of sensor `id`. The
/// metadata state the device; the pose is that of the body at the start. Lost samples are left out,
/// and saturated ones have flag 1, which keeps quality control from using them.
Recording recording_of(const RecordingImu& recorder, unsigned id, const Vec3& position,
                       const Quat& attitude);
/// The recordings of all inertial recorders of a scene, numbered from 1 in their order, with the
/// present poses of their bodies: by their devices, or by devices without errors
/// (&InertialRecorder::exact).
std::vector<Recording>
recordings_of(const World& world, RecordingImu InertialRecorder::*by = &InertialRecorder::device);

/// The recordings with the poses in which their sensor rocks were placed in a mould, relative to
/// its radius and height.
std::vector<Recording> with_poses(std::vector<Recording> recordings,
                                  const SpecimenSettings& specimen,
                                  const std::vector<SmartRockPose>& poses);

} // namespace bris
