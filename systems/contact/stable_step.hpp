#pragma once

#include "engine/world.hpp"

#include <vector>

namespace bris {

/// Stiffness that the touching contacts oppose to a body's motion.
struct BodyStiffness {
    double translation = 0; ///< N/m, sum over contacts of the larger of kn and ks
    double rotation = 0;    ///< N m/rad, sum of kn |c x n|^2 + ks |c|^2, c the lever arm
};

/// By row of body, from the pairs that touched in the last step.
std::vector<BodyStiffness> body_stiffness(const World& world);

/// Largest stable step, s: 2/omega with omega^2 = 2 max over free bodies of K/m + K_rotation/I_min
/// (a bound: one contact couples both motions, and the factor 2 lets the partners move too). Infinite if nothing
/// touches: see stable_step_of_first_contact.
double stable_step(const World& world);

/// The same bound if every rock, held ones too, had one contact of the stiffest kind; for the first
/// steps of a scene in which nothing touches yet.
double stable_step_of_first_contact(const World& world);

/// What mass scaling did.
struct MassScaling {
    double dt = 0;             ///< s
    double total_mass = 0;     ///< kg, scaled, of free bodies
    double largest_factor = 0; ///< of scaled to true mass
    double smallest_factor = 0;
};

/// Gives every free body the inertial mass and inertia with which the step `dt` is `safety` times its
/// stable step; for quasi-static runs (equilibria do not depend on mass). A body
/// counts at least six contacts, for those that may come. With dt = 0 the step is chosen so that the total mass
/// stays the true one. Scaled masses never shrink if `only_raise`. Weight keeps the true mass.
MassScaling scale_masses(World& world, double dt, double safety, bool only_raise);

/// Puts the true masses back.
void unscale_masses(World& world);

} // namespace bris
