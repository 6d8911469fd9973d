#include "systems/contact/mass_scaling.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/loads/table.hpp"

#include <algorithm>
#include <limits>

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);
constexpr double least_contacts = 6; // a stable rock has six or more

/// Contacts that a rock counts at least. One that is much larger than the others may have many more
/// within a few steps, in proportion to the surface on which the centres of its neighbours lie:
/// with six, a rock of five times the mean radius was thrown at 1 100 m/s when a tap pressed it
/// into its neighbours. Up to three times the mean radius six have sufficed.
double contacts_of(double radius_over_mean) {
    constexpr double usual = 3;
    const auto surface = [](double radius) { return 0.25 * (1 + radius) * (1 + radius); };
    return least_contacts * std::max(1.0, 1 + surface(radius_over_mean) - surface(usual));
}

/// N/m, from which on a pair is one of two rigid boundaries, which never touch.
constexpr double rigid = 1e20;

} // namespace

InertialMasses::InertialMasses(Table& bodies)
    : mass_(bodies.column<InertialMass>()),
      work_(bodies.has<ScalingWork>() ? bodies.column<ScalingWork>() : std::span<double>()),
      inertia_(bodies.column<Inertia>()), inertial_inertia_(bodies.column<InertialInertia>()),
      momentum_(bodies.column<AngularMomentum>()), velocity_(bodies.column<Velocity>()),
      angular_velocity_(bodies.column<AngularVelocity>()) {}

void InertialMasses::set(Row body, double mass, double of_inertia) {
    // all components of the inertia are scaled by one factor
    const double turning = of_inertia * inertia_[body].x() / inertial_inertia_[body].x();
    if (!work_.empty())
        work_[body] += 0.5 * (mass - mass_[body]) * velocity_[body].squaredNorm() +
                       0.5 * (turning - 1) * momentum_[body].dot(angular_velocity_[body]);
    momentum_[body] *= turning;
    mass_[body] = mass;
    inertial_inertia_[body] = of_inertia * inertia_[body];
}

MassScaling scale_masses(World& world, double dt, double safety, bool only_raise) {
    auto stiffness = body_stiffness(world);
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto mass = bodies.column<Mass>();
    const auto inertial = bodies.column<InertialMass>();
    const auto inertia = bodies.column<Inertia>();
    const auto inertial_inertia = bodies.column<InertialInertia>();
    InertialMasses masses(bodies);
    const ElementSprings springs(world);
    auto rows = rows_by_id(bodies.column<BodyId>()); // sums must not depend on the order of rows
    std::erase_if(rows, [&](Row b) { return motion[b] != free_motion; });

    // Contacts may form at any time, so at least as many of the stiffest pair of materials count as
    // a stable rock has. The pair of two boundary materials is included, although it is a third
    // stiffer than any contact of rocks: without it, the preparation leads to other packings of the
    // same porosity, which are half as strong again.
    // Fines only soften contacts; without them the contact is the same.
    double one = 0, true_mass = 0, stiffness_sum = 0, mean_radius = 0;
    const auto& materials = world.resource<Materials>();
    for (std::size_t pair = 0; pair < materials.pairs_of_materials(); ++pair)
        if (const LawRow& law = materials.linear_pairs[pair]; law.kn < rigid)
            one = std::max({one, law.kn, law.ks});
    require(one > 0, "mass scaling: expected materials with a normal stiffness, found none");
    const auto radius = bodies.column<BoundingRadius>();
    for (const Row b : rows) mean_radius += radius[b] / static_cast<double>(rows.size());
    for (const Row b : rows) {
        BodyStiffness& k = stiffness[b];
        const double least = contacts_of(radius[b] / mean_radius) * one;
        k.translation = std::max(k.translation, least);
        k.rotation = std::max(k.rotation, 0.25 * least * radius[b] * radius[b]);
        stiffness_sum += k.translation;
        true_mass += mass[b];
    }
    MassScaling result;
    // K/m = K_rotation/I = (safety / dt)^2, from dt = safety * 2 / sqrt(2 (K/m + K_rotation/I))
    result.dt = dt > 0 ? dt : safety * std::sqrt(true_mass / stiffness_sum);
    result.smallest_factor = std::numeric_limits<double>::infinity();
    const double factor = result.dt * result.dt / (safety * safety);
    for (const Row b : rows) {
        double m = factor * stiffness[b].translation;
        double i = factor * stiffness[b].rotation / inertia[b].minCoeff();
        if (!springs.of(b).empty()) { // whose dashpots suit the true mass
            m = std::max(m, mass[b]);
            i = std::max(i, 1.0);
        }
        if (only_raise) {
            m = std::max(m, inertial[b]);
            i = std::max(i, inertial_inertia[b].x() / inertia[b].x());
        }
        masses.set(b, m, i);
        result.total_mass += m;
        result.largest_factor = std::max(result.largest_factor, m / mass[b]);
        result.smallest_factor = std::min(result.smallest_factor, m / mass[b]);
    }
    // the dashpots of contacts read copies of the masses, which are renewed with the velocities
    world.resource<ListState>().velocities_changed = true;
    return result;
}

} // namespace bris
