#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"

namespace bris {

// How a correction enters the motion of its body: in the step, from the forces to the places.
// Scenes without sensors have no column Correction, and none of this.

/// Books the work of the corrections against the forces on their bodies, weight among them: the
/// force of this step times the mean of the shifts before and after it.
void accumulate_correction_work(
    Rows<Bodies, const Guided, const Force, const Torque, const Correction, FusionWork> bodies);

/// Turns clumps, after their own motion of the step.
void apply_correction_rotation(Rows<Bodies, const Guided, const Correction, Orientation> bodies);

/// Shifts bodies, after their own motion of the step, and counts it; lets go those that are where
/// they should be.
void apply_correction_displacement(
    Rows<Bodies, Correction, const Nudging, Guided, Position> bodies);

/// Tells contacts of the motion that they are to feel, besides the body's own.
void apply_correction_velocity(Rows<Bodies, const Guided, const Correction, RigidMotion> bodies,
                               const Clock& clock);

/// Gives a body a way to go: all of `shift` (m) and `turn` (rad) within `steps`; a correction that
/// was under way ends. 1 step: it is put there, as by hand, and friction does not notice.
void set_correction(CorrectionRow& row, std::uint32_t& guided, const Vec3& shift, const Vec3& turn,
                    unsigned steps);

} // namespace bris
