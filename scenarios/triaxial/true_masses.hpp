#pragma once

#include "engine/world.hpp"

namespace bris {

/// Gives every free rock its true inertial mass and inertia again, as if they had never been
/// scaled; velocities and spins stay, what that does to the kinetic energy is booked as work of
/// scaling. Returns the largest stable step (s): of the contacts of the last step, and of one
/// contact that may come.
double restore_masses(World& world);

} // namespace bris
