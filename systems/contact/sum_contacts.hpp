#pragma once

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Chooses the units in which contact forces are added, from the stiffness of the materials, the
/// limit of overlap and the largest body. They change only if the scene is changed from outside.
void choose_force_grid(const Materials& materials, const ContactLaw& law, const Limits& limits,
                       const Census& bodies, ForceGrid& grid);

/// Adds the contact forces on each boundary, and clears their sums for the next step.
void sum_boundaries(Rows<Bodies, const SumsFromOthers> bodies,
                    Rows<ForceSums, const NextSum, ContactSum> sums, const Census& census,
                    BoundarySums& boundaries);

/// Converts the sums of contact forces, and their torques about the centre of mass, to N and N m,
/// and clears the sums for the next step. Bodies whose sum is beyond the grid get NaN, at which the
/// guard stops the run.
void sum_contacts(Rows<Bodies, const SumsFromOthers, const SpheresOf, Force, Torque> bodies,
                  Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries);

} // namespace bris
