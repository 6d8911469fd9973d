#pragma once

#include "components/material.hpp"

namespace bris {

/// Target of an impact. Facets lie in the plane z = 0: `facet` is hit inside a facet, `edge` on the
/// shared edge of two facets, `vertex` on the shared vertex of four facets. All three must act as a
/// plane does.
enum class Target : std::uint32_t { sphere, plane, facet, edge, vertex };

/// One impact of a sphere, without gravity. The normal is z, from the target to the sphere. The
/// sphere comes from above and moves along x. No other forces act on the partner, which is a sphere
/// or a fixed surface.
struct Impact {
    Target target = Target::plane;
    double radius = 0.01;         ///< m, > 0
    double partner_radius = 0.01; ///< m, > 0, of a partner sphere
    Material material, partner_material;
    LawName law = LawName::hertz_mindlin_viscous;
    ContactPolicy policy;
    double speed = 1;         ///< m/s, relative, > 0
    double angle = 0;         ///< rad between velocity and normal, in [0, pi/2)
    double partner_share = 0; ///< share of the speed that a partner sphere has, in [0, 1]
    Vec3 angular_velocity = Vec3::Zero(), partner_angular_velocity = Vec3::Zero(); ///< rad/s
    double local_damping = 0;       ///< fraction, in [0, 1)
    double steps_per_contact = 200; ///< time steps in the undamped contact time, > 1
    double phase = 0.5; ///< time steps from the first touch to the first force, in [0, 1)
};

/// Reduced mass (kg), reduced radius (m) and stiffness of the normal contact of an impact, with its
/// closed forms.
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
/// Normal contact of two equal spheres in a head-on collision.
NormalContact like_spheres(const Material& material, LawName law, double radius, double speed);

struct ImpactResult {
    double largest_overlap = 0; ///< m, by a parabola through the three largest values
    double largest_force = 0;   ///< N, normal force, by a parabola through the three largest values
    double contact_time = 0;    ///< s, until the surfaces separate
    double normal_restitution = 0; ///< normal relative speed of the centres, after over before
    /// Tangential relative speed of the centres, after over before. NaN in a normal impact.
    double tangential_restitution = 0;
    /// After the impact, rad/s.
    Vec3 angular_velocity = Vec3::Zero(), partner_angular_velocity = Vec3::Zero();
    double slip = 0;            ///< m/s, relative velocity of the surfaces along x after the impact
    double slip_before = 0;     ///< m/s, the same before the impact
    double rebound_angle = 0;   ///< rad, atan(slip / normal speed) after the impact
    double energy_change = 0;   ///< relative to the kinetic energy before
    double momentum_change = 0; ///< relative to sum m |v|; partner spheres only
    double angular_momentum_change = 0; ///< relative to sum m |v| r; partner spheres only
    double friction_ratio = 0;          ///< largest ratio of tangential to normal force
    /// Work in the energy budget, J.
    double friction_work = 0, viscous_work = 0, rolling_work = 0;
    double energy_before = 0;       ///< J
    double energy_budget_error = 0; ///< (energy before - after - dissipated work) / before
    std::uint64_t steps = 0;
};

/// Throws InputError for settings out of range, or a time step in which a dashpot takes more than
/// the whole speed.
void check(const Impact& impact);
/// Runs one impact. The error is of second order in dt, and of fourth order without damping and
/// friction. Throws as check, and SimulationError if the contact does not end within 50 contact
/// times.
ImpactResult run_experiment(const Impact& impact);

} // namespace bris
