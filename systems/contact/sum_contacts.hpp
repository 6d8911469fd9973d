#pragma once

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Chooses the units in which contact forces are added, from the stiffness and the dashpots of the
/// materials, the limits of overlap and speed, and the largest body. They change only if the scene
/// is changed from outside.
void choose_force_grid(const Materials& materials, const ContactLaw& law, const Limits& limits,
                       const Census& bodies, ForceGrid& grid);

/// Adds the contact forces on each boundary, and clears their sums for the next step. Leaves out
/// sums that may have wrapped.
void sum_boundaries(Rows<Bodies, const BodyId, const SumsFromOthers> bodies,
                    Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                    const Census& census, BoundarySums& boundaries, Overload& overload);

/// Converts the sums of contact forces, and their torques about the centre of mass, to N and N m,
/// and clears the sums for the next step. Raises the alarm where sums may have wrapped; such bodies
/// get no force, and their sums are left for guard_sums.
void sum_contacts(Rows<Bodies, const SumsFromOthers, const SpheresOf, Force, Torque> bodies,
                  Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries, Alarm& alarm);

/// Finds the body whose sums may have wrapped, and clears them.
void guard_sums(Rows<Bodies, const BodyId> bodies, Rows<ForceSums, ContactSum> sums,
                const ForceGrid& grid, const Alarm& alarm, Overload& overload);

} // namespace bris
