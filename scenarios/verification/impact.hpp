#pragma once

#include "components/material.hpp"

namespace bris {

/// What a sphere flies against. Facets lie in the plane z = 0: `facet` is hit in its middle, `edge`
/// on the line that two of them share, `vertex` on the corner of four; all are to do what a plane
/// does.
enum class Target : std::uint32_t { sphere, plane, facet, edge, vertex };

/// One impact of a sphere, without weight. The normal is z, from the target to the sphere; the
/// sphere comes from above and moves along x. The partner (a sphere or a fixed surface) is free of
/// forces from elsewhere.
struct Impact {
    Target target = Target::plane;
    double radius = 0.01;         ///< m, > 0
    double partner_radius = 0.01; ///< m, > 0, of a sphere
    Material material, partner_material;
    LawName law = LawName::hertz_mindlin_viscous;
    ContactPolicy policy;
    double speed = 1;         ///< m/s, relative, > 0
    double angle = 0;         ///< rad between velocity and normal, in [0, pi/2)
    double partner_share = 0; ///< of the speed that the partner sphere has, in [0, 1]
    Vec3 angular_velocity = Vec3::Zero(), partner_angular_velocity = Vec3::Zero(); ///< rad/s
    double local_damping = 0;       ///< fraction, in [0, 1)
    double steps_per_contact = 200; ///< of the undamped contact time, > 1
    double phase = 0.5; ///< of a step, from the first touch to the first force, in [0, 1)
};

/// Reduced mass (kg), radius (m) and stiffness of the normal contact of an impact, by the closed
/// forms.
struct NormalContact {
    double mass, radius;
    double stiffness; ///< N/m (linear), N/m^1.5 (Hertz: 4/3 E* sqrt R*)
    double speed;     ///< m/s, along the normal
    bool hertz;
    double largest_overlap() const; ///< m, undamped (Johnson 1985, eq. 11.22)
    double largest_force() const;   ///< N, undamped
    double time() const; ///< s, undamped: 4/5 B(2/5, 1/2) overlap / speed, or pi sqrt(m/k)
};
NormalContact normal_contact(const Impact& impact);
/// Of two like spheres that meet head on.
NormalContact like_spheres(const Material& material, LawName law, double radius, double speed);

struct ImpactResult {
    double largest_overlap = 0;    ///< m, by a parabola through the three largest
    double largest_force = 0;      ///< N, normal, likewise
    double contact_time = 0;       ///< s, to the instant at which the surfaces part
    double normal_restitution = 0; ///< normal relative speed of the centres after over before
    double tangential_restitution =
        0; ///< the same of the tangential speed of the centres; nan at normal impact
    Vec3 angular_velocity = Vec3::Zero(), partner_angular_velocity = Vec3::Zero(); ///< rad/s, after
    double slip = 0; ///< m/s, of the surfaces at the contact after it, along x
    double slip_before = 0;
    double rebound_angle = 0;           ///< rad, atan(slip / normal speed after)
    double energy_change = 0;           ///< of the kinetic energy before
    double momentum_change = 0;         ///< of sum m |v|; sphere partners
    double angular_momentum_change = 0; ///< of sum m |v| r; sphere partners
    double friction_ratio = 0;          ///< largest tangential over normal force
    double friction_work = 0, viscous_work = 0,
           rolling_work = 0;        ///< J, booked by the energy ledger
    double energy_before = 0;       ///< J
    double energy_budget_error = 0; ///< (energy before - after - booked work) / before
    std::uint64_t steps = 0;
};

/// Runs one impact. Error of second order in dt, of fourth without damping and friction. Throws
/// SimulationError if the contact does not end in 50 contact times.
ImpactResult run_experiment(const Impact& impact);

} // namespace bris
