#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/recorder.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"
#include "engine/signal/imu.hpp"
#include "engine/world.hpp"

#include <vector>

namespace bris {

/// A device and what it has recorded.
struct RecordingImu {
    Imu imu;
    std::vector<ImuSample> samples = {};
};

/// An inertial sensor on a body of the running simulation, and beside it one without errors, which
/// tells what of a recording is motion and what is noise.
struct InertialRecorder {
    EntityId body;
    RecordingImu device, exact;
};

/// The inertial recorders of a scene. They record while `running`.
struct InertialRecorders {
    static constexpr auto name = "inertial_recorders";
    static constexpr bool is_state = true;
    bool running = false;
    double start = 0; ///< s, of the first sample
    std::vector<InertialRecorder> list;

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Whether inertial recorders are running.
bool is_recording(const World& world);

/// Notes the motion of the bodies that have inertial recorders. Force and Torque must be complete:
/// they give the accelerations at the time of the positions. Each row writes its own motion only.
void note_motion(Rows<Bodies, const RecorderOf, const MotionOf, const Force, const Torque,
                      const InertialMass, const InertialInertia, const Orientation,
                      const AngularVelocity, const Velocity, const DriveVelocity>
                     bodies,
                 const InertialRecorders& recorders, NotedMotions& motions, const Clock& clock);

/// Lets the inertial recorders follow the motion that was noted, and takes the samples that are
/// due: sample n in the step whose time is nearest to start + n / rate, with the time of that step.
/// The sensor's low pass acts at every step, so before sampling. A step that has failed is left
/// out.
void record_motion(const NotedMotions& motions, InertialRecorders& recorders, const Clock& clock,
                   const Health& health);

} // namespace bris
