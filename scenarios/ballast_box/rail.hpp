#pragma once

#include <span>
#include <vector>

namespace bris {

/// Reactions of ties under a rail with one unit load: an Euler-Bernoulli beam with free ends that
/// is fastened to springs. `at`: m, positions of the ties; `support`: N/m, spring of one tie;
/// `bending`: N m2, stiffness E I of the rails together; `load`: m, position of the load. The
/// reactions add up to 1 and may be negative (uplift is held). With one or two ties statics alone
/// determine them. Throws InputError unless there are ties at ascending positions and the
/// stiffnesses are above 0.
std::vector<double> rail_reactions(std::span<const double> at, double support, double bending,
                                   double load);

} // namespace bris
