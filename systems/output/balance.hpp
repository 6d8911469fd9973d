#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"

namespace bris {

/// Deviation of a world from equilibrium, from the contact forces of the last step.
struct Balance {
    /// Mean magnitude of the resultant on free bodies / mean sum of the magnitudes of the forces on
    /// them; 1 if there are no forces.
    double unbalanced_ratio = 1;
    std::size_t contacts = 0; ///< touching pairs
    std::size_t free_bodies = 0;
    std::size_t idle_bodies = 0; ///< free bodies without contacts
};

/// Computes the balance, of a divided world as compute_quantities does. The bits do not depend on
/// the order of the rows.
Balance compute_balance(const World& world);

} // namespace bris
