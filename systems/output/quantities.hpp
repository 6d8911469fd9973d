#pragma once

#include "engine/math.hpp"
#include "engine/summary.hpp"
#include "engine/world.hpp"

namespace bris {

/// What a scene looks like mechanically, summed over bodies and contacts in id order. Contacts are
/// those of the last step, from before bodies moved in it: kinetic and elastic energy are a step
/// apart.
struct Quantities {
    double kinetic_energy = 0;     ///< J, at the time of the positions, inertial masses
    double elastic_energy = 0;     ///< J, normal, tangential and rolling springs
    double coordination = 0;       ///< touching partners per free body (boundaries count)
    std::size_t contacts = 0;      ///< touching pairs of spheres or of sphere and boundary
    std::size_t body_contacts = 0; ///< touching pairs of bodies
    double mean_overlap = 0;       ///< m, of touching pairs
    double largest_overlap = 0;    ///< m
    double mean_normal_force = 0;  ///< N
    double unbalanced_ratio =
        0; ///< mean unbalanced force / mean sum of contact and applied forces; 1 if nothing carries
    Vec3 boundary_force = Vec3::Zero(); ///< N, of all grains on all driven bodies
    Vec3 weight = Vec3::Zero();         ///< N, of all free bodies
};

/// Measures the world as the last step left it. Reads only.
Quantities compute_quantities(const World& world);

/// Mean bounding radius (m) of the free bodies; not a number if there are none.
double mean_radius(const World& world);

/// The usual keys of a mechanical scene: energies, contacts, coordination, overlaps, unbalanced
/// ratio.
void add_quantities(Summary& summary, const Quantities& quantities);

} // namespace bris
