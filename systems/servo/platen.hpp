#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Drives the top platen: at its given speed, or, where `controlled`, so that the grains' force on it
/// approaches target pressure times the mean area inside the membrane, by the rule of the membrane.
void steer_platen(Rows<Planes, const HostRow> planes, Rows<Bodies, const Force, DriveVelocity> bodies,
                  Rows<Elements, const ElementRadius> elements, Platen& platen, const Membrane& membrane,
                  const NearIndex<PlanePairs>& index, const Clock& clock);

} // namespace bris
