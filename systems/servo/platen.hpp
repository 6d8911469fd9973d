#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Counts the grains that touch the platen, where its pressure is controlled. In a divided world
/// these are the grains of this rank, which share_platen_contacts adds up.
void count_platen_contacts(Rows<NearPlanes, const NearPair> near,
                           const NearIndex<PlanePairs>& index, Platen& platen);

/// Moves the top platen (Motion::servo) by one step: at its given speed or, where `controlled`, as
/// its force balance requires (ServoMotion). The balance is between the force of the grains, less
/// the pull of a sleeve, and the set point of the pressure (PressureAim) on the mean area inside
/// the membrane, with the axial load of a cyclic test (LoadRamp). The servo uses the forces of this
/// same step, because a speed that lags by a step would amplify the oscillation of the platen. A
/// platen that reaches the bottom, z = 0, has met no grains: this is recorded in Health and stops
/// the run.
void servo_platen(
    Rows<Planes, const HostRow> planes,
    Rows<Bodies, const Force, const PrunedAt, Position, Velocity, DisplacementBound> bodies,
    Platen& platen, const Clock& clock, Health& health);

/// Accumulates the half of the platen's work that belongs to its new speed.
/// accumulate_boundary_work accumulates the other half, at the speed of the last step.
void accumulate_platen_work(Rows<Planes, const HostRow> planes,
                            Rows<Bodies, const Force, const Velocity, BoundaryWork> bodies,
                            const Platen& platen, const Clock& clock);

} // namespace bris
