#pragma once

#include "scenarios/specimens/specimen.hpp"
#include "systems/output/porosity.hpp"

namespace bris {

// The present state of a specimen: its dimensions, its contact properties, its sensor rocks.

/// Radius (m) of the circle inside the membrane. Valid while all elements have the same radius.
double membrane_radius(const World& world);

/// Height (m) of the top platen.
double platen_height(const World& world);

/// Volume (m3) inside the membrane and the platens.
double specimen_volume(const World& world);

/// Size of a specimen and the stresses of its boundaries in the last step; compression positive.
/// Within a sleeve they are those that a laboratory measures: the load on the platens, which carry
/// the sleeve too, and the pressure of the cell.
struct SpecimenLoad {
    double height, volume;              ///< m, m3
    double axial_stress, radial_stress; ///< Pa
};
SpecimenLoad specimen_load(const World& world);

/// Mean radius (m) of the membrane at the height of each of its rings, or, of a sleeve, of as many
/// equal parts of its height.
std::vector<double> ring_radii(const World& world);

/// The core, the region in which porosity is measured: 0.6 of the radius, the middle half of the
/// height.
CylinderRegion core(const World& world);

/// Mean size (m, of a sphere of the same volume) of the rocks, weighted by mass.
double mean_size(const World& world);

/// Sets the friction coefficient between rocks and between rock and platen. Platens, and shells of
/// sensor rocks, that have a friction coefficient of their own keep it; in a contact the lower
/// coefficient of the two partners acts (Materials::mix).
void set_friction(World& world, double friction);
/// Sets the friction coefficient, and the normal and shear contact stiffness of one partner (N/m)
/// of rocks and sensor rocks; updates the contact stiffness that the servos use.
void set_rocks(World& world, double friction, double stiffness);

/// Normal stiffness (N/m) of a contact of a rock with the membrane, which the servos use.
double wall_contact_stiffness(const World& world);

/// Displacement of a sensor rock from its given pose, with the height scaled to the present height
/// of the specimen.
struct SensorDrift {
    EntityId body;
    Vec3 given, now; ///< m
    double rotation; ///< rad
};
std::vector<SensorDrift> sensor_drift(const World& world);

/// Sets the velocities of all bodies to zero.
void stop_rocks(World& world);

/// Drives the held sensor rocks with the platen: within `steps` they approach the positions that
/// correspond to its present height. A sensor rock on which the contact force exceeds ten times the
/// target pressure of the platen on its cross-section gives way, as far as the mould. A sensor rock
/// between its place and such forces can move to and fro for ever, so that the rocks around it do
/// not come to rest; with `halve_reversals` its steps are halved whenever their direction reverses,
/// and it comes to rest, but also follows the platen more slowly.
void lead_sensor_rocks(World& world, std::uint64_t steps, bool halve_reversals = false);

} // namespace bris
