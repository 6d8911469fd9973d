#pragma once

#include "engine/math.hpp"
#include "engine/summary.hpp"
#include "engine/world.hpp"

namespace bris {

/// Mechanical quantities of a scene, summed over bodies and contacts (ExactSum). The
/// contacts are those at the beginning of the last step, so elastic energy is one step older than
/// kinetic energy.
struct Quantities {
    double kinetic_energy = 0; ///< J, at the time of the positions, with inertial masses
    /// J, of normal, tangential and rolling springs, of force elements, and the potential energy of
    /// forces that act beyond touch (negative where they attract).
    double elastic_energy = 0;
    double element_energy = 0; ///< J, the part of force elements
    double coordination = 0;   ///< touching partners per free body (boundaries count)
    /// Touching pairs of spheres or of sphere and boundary, without pairs that only a force beyond
    /// touch holds.
    std::size_t contacts = 0;
    std::size_t body_contacts = 0; ///< touching pairs of bodies
    double mean_overlap = 0;       ///< m, of touching pairs
    double largest_overlap = 0;    ///< m
    double mean_normal_force = 0;  ///< N
    /// Mean unbalanced force / mean sum of contact and applied forces; 1 if there are no forces.
    double unbalanced_ratio = 0;
    Vec3 boundary_force = Vec3::Zero(); ///< N, of all grains on all driven bodies
    Vec3 weight = Vec3::Zero();         ///< N, of all free bodies

    /// Vertical force of all grains on all driven bodies over their weight: 1 at rest; 0 without
    /// weight.
    double boundary_force_over_weight() const {
        return weight.z() < 0 ? boundary_force.z() / weight.z() : 0;
    }
};

/// Computes the quantities of the world after the last step: of a whole one, or with the other
/// ranks of one of which each has a part (Simulation::observed), to the same bits. Reads only.
Quantities compute_quantities(const World& world);

/// J, of the weights of all bodies, above the origin; 0 without gravity.
double potential_energy(const World& world);

/// Share of the contacts between grains that are at yield: the pressure of Hertz is the strength of
/// their edges, and with it their friction does not change with the force. 0 without such edges.
double share_at_yield(const World& world);

/// Mean bounding radius (m) of the free bodies with spheres; NaN where there are none.
double mean_radius(const World& world);

/// Adds the usual quantities of a mechanical scene to a summary: energies, contacts, coordination
/// number, overlaps and unbalanced force ratio.
void add_quantities(Summary& summary, const Quantities& quantities);

} // namespace bris
