#pragma once

#include "engine/world.hpp"

namespace bris {

/// Settings for spreading corrections over bodies without a sensor.
struct SpreadSettings {
    /// Stiffness that holds sensor bodies at their corrections, relative to the mean contact
    /// stiffness.
    double hold = 1e3;
    /// Stiffness that holds every body at its present pose, relative to the mean contact stiffness:
    /// keeps bodies in place that the contacts alone would leave free to move.
    double float_free = 1e-3;
    /// Tolerance of the solution (motion_of_least_energy). With the default the displacements have
    /// a mean error of half a percent.
    double tolerance = 1e-3;
};

/// Spreads the corrections of sensor bodies (Correction, not yet begun) over the free bodies that
/// can be reached from them contact by contact, so that the springs of the present contacts store
/// the least energy. Minimises u K u / 2 + w |u_s - d|^2 / 2 over the shifts and rotations u, where
/// K is the stiffness of the contact network (normal springs, and tangential springs of contacts
/// that stick), d the corrections and w the stiffness that holds the sensor bodies at them. To
/// first order no body without a sensor receives a net force. Driven bodies and boundaries stay
/// where they are, and so do bodies without contacts. For linear contact laws. Nothing is stored
/// for the next analysis, whose contacts differ. Returns the energy u K u / 2, J.
double spread_corrections(World& world, const SpreadSettings& settings = {});

/// Energy (J) that the springs of the present contacts store if the sensor bodies follow their
/// corrections and all other bodies stay.
double energy_of_corrections(const World& world);

} // namespace bris
