#pragma once

#include "engine/world.hpp"

namespace bris {

/// How a box with loaded ties balances, from the forces of the last step.
struct BoxBalance {
    double unbalanced_ratio = 1; ///< unbalanced force ratio of all free bodies
    double tie_load = 0;         ///< N, loads and weights of the ties
    double tie_support = 0;      ///< N, vertical force of the ballast on the ties
    double subgrade_force = 0;   ///< N, vertical force of the ballast on the plates of the subgrade
    bool carries = false;        ///< there are enough contacts to carry load
    /// Share of the loads of the ties that the ballast carries; 1 at rest.
    double support() const { return tie_load > 0 ? tie_support / tie_load : 0; }
};
BoxBalance box_balance(const World& world);

} // namespace bris
