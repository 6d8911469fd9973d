#pragma once

#include <cstdint>

namespace bris {

/// A small sphere that comes to rest between two large fixed spheres (Vyas et al. 2025) and must
/// stay at rest.
struct SmallBetweenLarge {
    double ratio = 10; ///< large radius over small radius, >= 1
    double friction = 0.5;
    double offset = 0.2; ///< initial distance from the middle, in small radii
};
/// Motion of the small sphere (radius r) at the end.
struct RestResult {
    double speed = 0;            ///< relative to sqrt(g r)
    double angular_velocity = 0; ///< relative to sqrt(g / r)
    double travel = 0;           ///< displacement in the last tenth of the run, in r
    double unbalanced = 0;       ///< resultant force relative to the weight
};
RestResult run_experiment(const SmallBetweenLarge& scene);

/// A clump that stands on a floor on three equal spheres, its feet, at the corners of an
/// equilateral triangle around the vertical through its centre of mass. The last sphere of the
/// clump is a foot.
struct Tripod {
    double height = 2; ///< of the centre of mass above the centres of the feet, in radii of a foot
};
struct TripodResult {
    double overlap = 0; ///< of the feet and the floor, in the weight over three contact stiffnesses
    double tilt = 0;    ///< rad, from the upright attitude
    double floor_force = 0; ///< relative to the weight
};
TripodResult run_experiment(const Tripod& tripod);

/// A packing of spheres of several sizes at rest in a box under its weight.
struct Packing {
    unsigned side = 3;
    std::uint64_t seed = 1;
};
struct PackingResult {
    double unbalanced_ratio = 0;
    double floor_force_error = 0; ///< |force of the grains on the box / weight - 1|
    /// Mismatch of contact stress (Love 1927, Weber 1966) and stress from boundary tractions.
    double stress_mismatch = 0;
    double coordination = 0; ///< coordination number
};
PackingResult run_experiment(const Packing& packing);

} // namespace bris
