#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/servo.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Moves the elements of a membrane so that the grains' pressure on each group (ring or element)
/// approaches the target: the velocity that would take `gain` of the error in one step against the
/// stiffness of the contacts that touch now, no more than `largest_step` a step. Pressure is force
/// over the area of the current polygon (inventory E3).
/// Only the part of the top ring below the platen counts. An element that its neighbours hide has no
/// area to press on: that is noted in Health and stops the run.
void steer_membrane(Rows<Facets, const HostRow> facets, Rows<Planes, const PlanePlace> planes,
                    Rows<Bodies, const Position, const Force, DriveVelocity> bodies, Membrane& membrane,
                    const Platen& platen, const NearIndex<FacetPairs>& index, const Clock& clock, Health& health);

/// Height (m) of a ring between its lower rim and the platen at height `top`.
double exposed_height(const Membrane& membrane, std::size_t ring, double top);

/// Width (m) of an element between the planes of its neighbours, which are turned by `angle` (rad)
/// and lie at the distances `before` and `after` from the axis; `own` is the element's own distance.
/// Negative if the neighbours hide it.
double exposed_width(double own, double before, double after, double angle);

} // namespace bris
