#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// Spheres that fly about in a smooth box, without weight.
struct Gas {
    unsigned side = 4;    ///< spheres along an edge of the cube that they start in
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::hertz_frictionless;
    double speed = 1;               ///< m/s, of each at the start
    double steps_per_contact = 100; ///< of a normal impact at that speed
    double contacts_long = 60;      ///< duration in contact times
    std::uint64_t seed = 1;
};
struct GasResult {
    double largest_change =
        0;                   ///< of kinetic and elastic energy, over that at the start, either way
    double largest_gain = 0; ///< upwards only
    double largest_rise = 0; ///< from any sample to a later one
    double last = 1;         ///< energy at the end over that at the start
    double contacts = 0;     ///< touching pairs, mean over the samples
    std::uint64_t steps = 0;
};
GasResult run_experiment(const Gas& gas);

/// A normal Hertz impact whose stiffness changes while in contact.
struct Stiffening {
    double factor = 2; ///< of Young's modulus
    double steps_per_contact = 1000;
};
struct StiffeningResult {
    double overlap = 0;  ///< m, when the stiffness changed
    double injected = 0; ///< of the kinetic energy before: by the impact's own speeds
    double exact = 0;    ///< 8/15 (E2* - E1*) sqrt(R*) overlap^(5/2), over the same
    double restitution = 0;
};
StiffeningResult run_experiment(const Stiffening& stiffening);

} // namespace bris
