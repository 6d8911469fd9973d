#pragma once

#include "scenarios/recordings/recording.hpp"
#include "systems/recorder/record_motion.hpp"

#include <string>
#include <vector>

namespace bris {

/// What an inertial recorder of a simulation has recorded, as a recording of sensor `id`. The
/// metadata state the device; the pose is that of the body at the start. Lost samples are left out,
/// and saturated ones have flag 1, which keeps quality control from using them.
Recording recording_of(const InertialRecorder& recorder, unsigned id, const Vec3& position,
                       const Quat& attitude);
/// The recordings of all inertial recorders of a scene, numbered from 1 in their order, with the
/// present poses of their bodies.
std::vector<Recording> recordings_of(const World& world);

} // namespace bris
