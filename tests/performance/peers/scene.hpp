#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"
#include "tests/performance/peers/bed.hpp"

#include <string>

namespace bris::peers {

/// What a scene of the comparison has of its own; the rest is the same in all.
struct Scene {
    std::string name;
    double normal_stiffness; ///< N/m, of a contact; the tangential one is 2/7 of it
    double
        damping_rate; ///< 1/s times the reduced mass, of the normal dashpot; half of it, tangential
    double step;      ///< s
    double gravity;   ///< m/s2
    bool falls = false;   ///< begins without contacts: at rest then, not half a step before
    bool pressed = false; ///< no weight; three of the walls can move
    double low = -1e9,
           high = 1e9; ///< m: spheres whose centres start below are held, those above drawn along x
    double speed = 0;  ///< m/s, of those
};

constexpr double density = 2600; // kg/m3
constexpr double friction = 0.5;
// Hertz and Mindlin; the tangential spring as stiffness times stretch, dashpots of Tsuji, as the
// other codes have it
constexpr double young_modulus = 5e8, poisson_ratio = 0.25, restitution = 0.3;

/// settle, fall (the same drawn apart), shear, quiet, poly, clumps, drop (those drawn apart),
/// triaxial (clumps pressed) or triaxial_spheres. Throws InputError.
Scene scene_named(const std::string& name);

LawName law_named(const std::string& name); ///< linear or hertz

/// A bed in its box of six planes, under gravity, with the clock's step set; lists are still to be
/// added. Stones have mass and inertia summed over their spheres, overlap counted twice, as in the
/// other codes.
World make_scene(const Bed& bed, const Scene& scene, LawName law);

/// The spheres where they are now, in the order of their ids, which is that of the bed they were
/// made from.
std::vector<Ball> balls_now(const World& world);

} // namespace bris::peers
