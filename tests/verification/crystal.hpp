#pragma once

#include "components/material.hpp"

#include <cstdint>
#include <vector>

namespace bris {

enum class CrystalLattice : std::uint32_t { simple, body_centred, face_centred };

/// Unit vectors from a sphere of a lattice to its neighbours, in ascending order of x.
std::vector<Vec3> neighbours(CrystalLattice lattice);
/// Volume of a sphere's cell, relative to the cube of the distance between neighbours.
double cell_volume(CrystalLattice lattice);

/// An infinite crystal of equal spheres under isotropic pressure. Every sphere is a centre of
/// symmetry, so under a uniform strain no sphere moves relative to its lattice site or rotates: one
/// sphere and its neighbours, displaced by the strain, represent the whole crystal.
struct Crystal {
    CrystalLattice lattice = CrystalLattice::face_centred;
    double spacing = 0.04; ///< m, between the centres of neighbours under pressure, > 0
    Material material;
    LawName law = LawName::hertz_mindlin;
    double pressure = 110e3; ///< Pa, > 0
    double strain = 1e-7;    ///< applied with both signs, > 0
};
struct CrystalResult {
    double contact_force = 0, overlap = 0; ///< N, m: 3 p V / (n_c d), and its overlap
    double pressure = 0;                   ///< Pa, from the computed contact forces
    double c11 = 0, c12 = 0, c44 = 0; ///< Pa, tangent moduli without the terms of initial stress
    double bulk = 0;                  ///< Pa, bulk modulus
    double unbalanced = 0; ///< largest resultant force on the sphere relative to the contact force
};
/// Throws InputError for a pressure or strain that is not above 0, or a strain that is too large.
void check(const Crystal& crystal);
/// Computes the moduli as stress (1/V) sum f l / 2 per strain, from the engine's contact forces at
/// plus and minus the strain. Second order in strain / (overlap / spacing). Changes of forces that
/// result only from the rotation of contacts are subtracted. Throws as check.
CrystalResult run_experiment(const Crystal& crystal);

/// A neighbour of a sphere in a wave. Its displacement is that of the sphere times `translation`,
/// its rotation that of the sphere times `angular_velocity`. Factors are 1, -1, or 0 if it is held.
struct Neighbour {
    Vec3 direction;
    double translation, angular_velocity;
};
/// All neighbours are held.
std::vector<Neighbour> held(CrystalLattice lattice);
/// All neighbours move and rotate as the sphere does: centre of the Brillouin zone.
std::vector<Neighbour> in_phase(CrystalLattice lattice);
/// The wave of highest frequency: points R, H and X of the Brillouin zone.
std::vector<Neighbour> zone_boundary(CrystalLattice lattice);
/// One held neighbour, as a wall.
std::vector<Neighbour> one_held();
/// One neighbour with opposite displacement and equal rotation: a free pair.
std::vector<Neighbour> free_pair();

/// The largest stable time step of a sphere with linear springs to its neighbours.
struct StabilityLimit {
    std::vector<Neighbour> around;
    double shear_ratio = 0; ///< ks / kn, >= 0
    /// Relative to the spacing. It is small, because contact forces slowly buckle a frictionless
    /// column.
    double overlap = 1e-6;
    unsigned steps = 400; ///< number of steps of each trial
};
/// Finds the limit in units of sqrt(m/kn) by bisection to 2e-4. A step is unstable if a disturbance
/// grows by a factor of 1e4. The engine moves the sphere; the experiment sets the positions and
/// velocities of its neighbours after every step. Returns infinity beyond 4 sqrt(m/kn), throws
/// SimulationError below 0.05 sqrt(m/kn).
double run_experiment(const StabilityLimit& limit);

} // namespace bris
