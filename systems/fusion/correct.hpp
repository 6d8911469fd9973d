#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"
#include "systems/loads/nudging.hpp"

namespace bris {

// How a correction enters the motion of its body within the step, from the forces to the positions.
// Scenes without sensors have no column Correction and none of these systems.

/// Accumulates the work of the corrections against the forces on their bodies, weight included: the
/// force of this step times the mean of the shifts before and after it.
void accumulate_correction_work(
    Rows<Bodies, const Guided, const Force, const Torque, const Correction, FusionWork> bodies);

/// Rotates clumps by their corrections, after their own motion in the step.
void apply_correction_rotation(Rows<Bodies, const Guided, const Correction, Orientation> bodies);

/// Shifts bodies by their corrections, after their own motion in the step, and counts down the
/// steps of each correction. Bodies without a pending correction or nudging are no longer guided.
void apply_correction_displacement(
    Rows<Bodies, Correction, const Nudging, Guided, Position> bodies);

/// Adds the velocity of the corrections that contacts are to see (CorrectionRow::as_motion) to the
/// body's own.
void apply_correction_velocity(Rows<Bodies, const Guided, const Correction, RigidMotion> bodies,
                               const Clock& clock);

/// Sets the correction of a body: `shift` (m) and `turn` (rad) in total, spread evenly over `steps`
/// steps. It replaces a pending correction. With 1 step it is a direct insertion, on which friction
/// does not act.
void set_correction(CorrectionRow& row, std::uint32_t& guided, const Vec3& shift, const Vec3& turn,
                    unsigned steps);

} // namespace bris
