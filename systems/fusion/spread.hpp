#pragma once

#include "engine/world.hpp"

namespace bris {

/// How a correction is spread over bodies without a sensor.
struct SpreadSettings {
    double hold = 1e3; ///< stiffness with which sensors are held to their corrections, of the mean
                       ///< contact stiffness
    double float_free =
        1e-3; ///< with which everybody is held to where it is, likewise: what hinges stays
    double tolerance = 1e-3; ///< of the solution (motion_of_least_energy): ways are then off by
                             ///< half a percent in the mean
};

/// Spreads the corrections that sensors' bodies have been given (Correction, not yet begun) over
/// the free bodies that can be reached from them contact by contact, such that the springs of the
/// present contacts store the least energy: minimises u K u / 2 + w |u_s - d|^2 / 2 over shifts and
/// turns u, with K the stiffness of the contact network (normal springs, and tangential ones of
/// contacts that stick). To first order nobody without a sensor gets a net force. Contacts with
/// driven bodies and boundaries hold; what touches nobody stays. Linear laws. Nothing is kept for
/// the next time, when contacts are others. Returns the energy u K u / 2, J.
double spread_corrections(World& world, const SpreadSettings& settings = {});

/// J, that the springs of the present contacts store if sensors' bodies go as they are to, and all
/// others stay.
double energy_of_corrections(const World& world);

} // namespace bris
