#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Moves the top platen (Motion::servo) by one step: at its given speed, or, where `controlled`, by
/// its balance of forces, the grains' push against the target pressure (PressureAim) on the mean
/// area inside the membrane (ServoMotion). It moves by the forces of this very step: a speed that
/// comes a step late would feed its oscillation. A platen that reaches the bottom, z = 0, has found
/// no grains: that is noted in Health and stops the run.
void servo_platen(
    Rows<Planes, const HostRow> planes,
    Rows<Bodies, const Force, const PrunedAt, Position, Velocity, DisplacementBound> bodies,
    Rows<Elements, const ElementRadius> elements, Platen& platen, const Membrane& membrane,
    const NearIndex<PlanePairs>& index, const Clock& clock, Health& health);

/// Books the half of the platen's work that belongs to its new speed; accumulate_boundary_work
/// books the other at the speed of the last step.
void accumulate_platen_work(Rows<Planes, const HostRow> planes,
                            Rows<Bodies, const Force, const Velocity, BoundaryWork> bodies,
                            const Platen& platen, const Clock& clock);

} // namespace bris
