#pragma once

#include "engine/world.hpp"

namespace bris {

/// Resets the inertial mass and inertia of every free rock to the true ones, as if they had never
/// been scaled. Velocities and angular velocities stay; the change in kinetic energy is accumulated
/// as work of scaling. Returns the largest stable step (s) for the contacts of the last step and
/// for one contact that may form.
double restore_masses(World& world);

} // namespace bris
