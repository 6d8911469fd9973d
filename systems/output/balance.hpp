#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"

namespace bris {

/// How far a world is from equilibrium, from the records of the last step.
struct Balance {
    double unbalanced_ratio =
        1;                    ///< mean |resultant| of free bodies / mean sum of |forces|; 1 if none
    std::size_t contacts = 0; ///< touching pairs
    std::size_t free_bodies = 0;
    std::size_t idle_bodies = 0; ///< free bodies that nothing touches
};

/// Measures the balance; the same bits for any order of the rows.
Balance compute_balance(const World& world);

} // namespace bris
