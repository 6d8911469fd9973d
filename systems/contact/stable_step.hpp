#pragma once

#include "engine/world.hpp"

#include <vector>

namespace bris {

/// Stiffness that the touching contacts oppose to a body's motion.
struct BodyStiffness {
    double translation = 0; ///< N/m, sum over contacts of the larger of kn and ks
    double rotation =
        0; ///< N m/rad, sum of kn |c x n|^2 + ks |c|^2, c the lever arm, and of rolling springs
};

/// By row of body, from the pairs that touched in the last step.
std::vector<BodyStiffness> body_stiffness(const World& world);

/// Largest stable step, s: 0.999 of 2/omega, less where dashpots act, with omega^2 the largest
/// eigenvalue of any free body's 6 x 6 block M^-1/2 K M^-1/2, contacts between two free bodies
/// counted twice: a bound, and 0.8 to 0.9 of the true limit in beds. Hertz: with the stiffness of
/// the present overlaps. Infinite if nothing touches: see stable_step_of_first_contact.
double stable_step(const World& world);

/// A bound if every rock, held ones too, had one contact of the stiffest kind (Hertz: as deep as an
/// impact at twice the largest speed, or half a percent of the radius); for the first steps of a
/// scene in which nothing touches yet.
double stable_step_of_first_contact(const World& world);

} // namespace bris
