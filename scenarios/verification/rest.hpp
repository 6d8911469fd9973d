#pragma once

#include <cstdint>

namespace bris {

/// A small sphere that comes to rest between two large ones that are held (Vyas et al. 2025): it
/// must stay.
struct SmallBetweenLarge {
    double ratio = 10; ///< radius of the large ones over that of the small one, >= 1
    double friction = 0.5;
    double offset = 0.2; ///< of the small radius, from the middle at the start
};
struct RestResult {
    double speed = 0;            ///< of the small one at the end, over sqrt(g r)
    double angular_velocity = 0; ///< rad/s sqrt(r / g), likewise
    double travel = 0;           ///< of r, in the last tenth of the run
    double unbalanced = 0;       ///< resultant over weight
};
RestResult run_experiment(const SmallBetweenLarge& scene);

/// A packing of spheres of several sizes in a box, at rest under its weight.
struct Packing {
    unsigned side = 3;
    std::uint64_t seed = 1;
};
struct PackingResult {
    double unbalanced_ratio = 0;
    double floor_force_error = 0; ///< |force of the grains on the box / weight - 1|
    double stress_mismatch =
        0; ///< of contact stress (Love 1927, Weber 1966) and boundary tractions
    double coordination = 0;
};
PackingResult run_experiment(const Packing& packing);

} // namespace bris
