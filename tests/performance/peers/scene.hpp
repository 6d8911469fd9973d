#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"
#include "tests/performance/peers/bed.hpp"

#include <string>

namespace bris::peers {

/// Parameters in which the scenes of the comparison differ. All others are the same in all scenes.
struct Scene {
    std::string name;
    double normal_stiffness; ///< N/m, of a contact; the tangential stiffness is 2/7 of it
    /// Damping coefficient of the normal dashpot over the reduced mass, 1/s. The tangential one is
    /// half of it.
    double damping_rate;
    double step;          ///< s
    double gravity;       ///< m/s2
    bool falls = false;   ///< starts without contacts, with velocities of 0 at t = 0, not at -dt/2
    bool pressed = false; ///< under pressure without gravity; three of the walls can move
    /// Heights, m. Spheres whose centres start below `low` are held, those above `high` move along
    /// x.
    double low = -1e9, high = 1e9;
    double speed = 0; ///< m/s, of the spheres above `high`
};

constexpr double density = 2600; // kg/m3
constexpr double friction = 0.5;
// Hertz and Mindlin with the tangential spring as stiffness times stretch and dashpots of Tsuji, as
// in the other codes
constexpr double young_modulus = 5e8, poisson_ratio = 0.25, restitution = 0.3;

/// The scene with a name: settle, fall (settle, stretched), shear, quiet, poly and poly5 (radii
/// 1:10 and 1:5), clumps, drop (clumps, stretched), triaxial (clumps under pressure) or
/// triaxial_spheres. Throws InputError.
Scene scene_named(const std::string& name);

LawName law_named(const std::string& name); ///< linear or hertz

/// A bed in its box of six planes under gravity, with the time step of the scene, without neighbour
/// lists. Mass and inertia of clumps are summed over their spheres, so that overlaps count twice,
/// as in the other codes.
World make_scene(const Bed& bed, const Scene& scene, LawName law);

/// The spheres (m) in their present positions, in the order of their ids, which is that of the bed.
std::vector<Ball> balls_now(const World& world);

} // namespace bris::peers
