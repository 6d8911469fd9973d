#pragma once

#include "components/body.hpp"
#include "engine/world.hpp"

#include <span>

namespace bris {

/// Changes the inertial masses of the bodies of a table. Velocities and angular velocities stay, so
/// the kinetic energy changes; where it is counted (ScalingWork), this is the work of scaling.
class InertialMasses {
public:
    explicit InertialMasses(Table& bodies);
    /// The inertial mass (kg), and the factor on the true inertia.
    void set(Row body, double mass, double of_inertia);

private:
    std::span<double> mass_, work_;
    std::span<Vec3> inertia_, inertial_inertia_, momentum_;
    std::span<const Vec3> velocity_, angular_velocity_;
};

/// Result of mass scaling.
struct MassScaling {
    double dt = 0;              ///< s, time step for which the masses are scaled
    double total_mass = 0;      ///< kg, sum of the scaled masses of free bodies
    double largest_factor = 0;  ///< largest ratio of scaled to true mass
    double smallest_factor = 0; ///< smallest ratio of scaled to true mass
};

/// Gives every free clump the inertial mass and inertia for which the step `dt` (s) is `safety`
/// times its stable step. This is meant for quasi-static runs, since equilibria do not depend on
/// mass. A body counts as having at least six contacts, because more may form, and a body of more
/// than three times the mean radius as many more as its larger surface offers. With dt = 0 the step
/// is chosen so that the total mass stays the true one. With `only_raise`, scaled masses never
/// decrease. The weight is that of the true mass. Bodies on springs of force elements keep at
/// least their true mass, for which their dashpots are made. Dashpots of contacts must follow from
/// a restitution, so that their ratio of critical damping does not depend on the masses; they read
/// the new masses in the next step.
MassScaling scale_masses(World& world, double dt, double safety, bool only_raise);

} // namespace bris
