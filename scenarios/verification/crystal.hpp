#pragma once

#include "components/material.hpp"

#include <cstdint>
#include <vector>

namespace bris {

enum class Lattice : std::uint32_t { simple, body_centred, face_centred };

/// Unit vectors from a sphere of a lattice to its neighbours, in the order of x.
std::vector<Vec3> neighbours(Lattice lattice);
/// Volume of a sphere's cell over the cube of the distance of neighbours.
double cell_volume(Lattice lattice);

/// An infinite crystal of equal spheres under isotropic pressure. Every sphere is a centre of
/// symmetry, so under a uniform strain none leaves its place or turns: one sphere and its
/// neighbours, moved by the strain, stand for all.
struct Crystal {
    Lattice lattice = Lattice::face_centred;
    double spacing = 0.04; ///< m, between the centres of neighbours (under pressure), > 0
    Material material;
    LawName law = LawName::hertz_mindlin;
    double pressure = 110e3; ///< Pa, > 0
    double strain = 1e-7;    ///< to either side, > 0
};
struct CrystalResult {
    double contact_force = 0, overlap = 0; ///< N, m: 3 p V / (n_c d), and its overlap
    double pressure = 0;                   ///< Pa, of the measured contact forces
    double c11 = 0, c12 = 0, c44 = 0;      ///< Pa, tangent, without the terms of initial stress
    double bulk = 0;                       ///< Pa
    double unbalanced = 0; ///< N, largest resultant on the sphere over the contact force
};
/// Moduli as stresses (1/V) sum f l / 2 per strain, from the engine's contact forces at plus and
/// minus the strain: second order in strain over overlap / spacing. What forces change only because
/// contacts turn is taken away.
CrystalResult run_experiment(const Crystal& crystal);

/// A sphere's neighbour in a wave: it moves as the sphere does times `translation`, and spins as it
/// does times `angular_velocity`: 1, -1, or 0 if it is held.
struct Neighbour {
    Vec3 direction;
    double translation, angular_velocity;
};
std::vector<Neighbour> held(Lattice lattice); ///< all neighbours held
std::vector<Neighbour>
in_phase(Lattice lattice); ///< all move and spin alike: centre of the Brillouin zone
std::vector<Neighbour>
zone_boundary(Lattice lattice);     ///< the wave of highest frequency: points R, H and X
std::vector<Neighbour> one_held();  ///< as a wall
std::vector<Neighbour> free_pair(); ///< opposite motion, equal spin

/// The largest stable step of a sphere with linear springs among its neighbours.
struct StabilityLimit {
    std::vector<Neighbour> around;
    double shear_ratio = 0; ///< ks / kn, >= 0
    double overlap =
        1e-6; ///< of the spacing; the force of contacts makes a frictionless column buckle, slowly
    unsigned steps = 400; ///< of each trial
};
/// Limit over sqrt(m/kn), by bisection to 2e-4: a step is unstable if a disturbance grows 1e4
/// times. The engine moves the sphere; its neighbours are put in their places by hand after every
/// step. Infinite beyond 4 sqrt(m/kn).
double run_experiment(const StabilityLimit& limit);

} // namespace bris
