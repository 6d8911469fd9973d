#pragma once

#include "engine/world.hpp"

#include <vector>

namespace bris {

/// Stiffness of the touching contacts of a body against its motion.
struct BodyStiffness {
    /// N/m, sum over contacts of the larger of kn and ks.
    double translation = 0;
    /// N m/rad, sum of kn |c x n|^2 + ks |c|^2 with the lever arm c, and of the rolling springs.
    double rotation = 0;
};

/// Stiffness of each body, by row, from the pairs that touched in the last step.
std::vector<BodyStiffness> body_stiffness(const World& world);

/// Largest stable time step (s): 0.999 times 2/omega, less where dashpots act. omega^2 is the
/// largest eigenvalue of the 6 x 6 blocks M^-1/2 K M^-1/2 of all free bodies, where contacts
/// between two free bodies count twice. This is a lower bound of the true limit, and 0.8 to 0.9 of
/// it in beds. Hertz contacts have the stiffness of their present overlaps. Infinite if nothing
/// touches: see stable_step_of_first_contact. Of a divided world as compute_quantities.
double stable_step(const World& world);

/// Stable time step (s) if every body with mass, including fixed ones, had one contact of the
/// stiffest kind; for the first steps of a scene in which nothing touches yet. The overlap of a
/// Hertz contact is taken as that of an impact at twice the largest speed, or half a percent of the
/// radius if that is more.
double stable_step_of_first_contact(const World& world);

} // namespace bris
