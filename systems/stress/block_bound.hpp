#pragma once

#include "engine/world.hpp"

namespace bris::stress {

/// A bound on the stable step (s) of undamped laws, from the 6 x 6 stiffness that the touching contacts oppose to each
/// body's motion: 2/omega, omega^2 the largest eigenvalue of any body's stiffness over its mass. A contact of two free
/// bodies counts twice, since (u - v)^2 <= 2 u^2 + 2 v^2. Rigorous; never longer than the limit.
double block_bound(const World& world);

} // namespace bris::stress
