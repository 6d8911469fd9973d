#pragma once

#include "scenarios/specimens/specimen.hpp"
#include "systems/output/porosity.hpp"

namespace bris {

// What a specimen is like now.

/// Radius (m) of the circle inside the membrane while all its elements stand at one.
double membrane_radius(const World& world);

/// Height (m) of the top platen.
double platen_height(const World& world);

/// Volume (m3) inside the membrane and the platens.
double specimen_volume(const World& world);

/// Where porosity is measured: 0.6 of the radius, the middle half of the height.
CylinderRegion core(const World& world);

/// Friction of rock on rock and rock on platen. Sensor rocks with shells of their own friction keep
/// it; on a rock, as on any partner, the lower of both acts (Materials::mix).
void set_friction(World& world, double friction);
/// And the stiffness of rocks and sensor rocks in contacts, normal and shear, of one partner (N/m);
/// servos go by it.
void set_rocks(World& world, double friction, double stiffness);

/// Normal stiffness (N/m) of a contact of a rock with the membrane, by which the servos go.
double wall_contact_stiffness(const World& world);

/// A sensor rock's way from its given pose, in a specimen of the present height, to where it is.
struct SensorDrift {
    EntityId body;
    Vec3 given, now; ///< m
    double turn;     ///< rad
};
std::vector<SensorDrift> sensor_drift(const World& world);

} // namespace bris
