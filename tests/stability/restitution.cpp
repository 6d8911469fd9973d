// S13: restitution from 0 to 1 and friction from 0 to 10 have their nominal values.
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

constexpr double radius = 0.01, kn = 1e6, density = 2600, modulus = 1e9, poisson = 0.25;

Material bouncing(double restitution) {
    Material m = linear_material(kn, 0, 0, density);
    m.restitution = restitution;
    m.young_modulus = modulus;
    m.poisson_ratio = poisson;
    return m;
}

/// Contact time (s) of an elastic impact on a plane.
double contact_time(LawName law, double mass, double speed) {
    if (!is_hertz(law)) return pi / std::sqrt(kn / mass);
    const double stiffness = 4.0 / 3 * 0.5 * modulus / (1 - poisson * poisson) * std::sqrt(radius);
    return 2.9432751843 * std::pow(5 * mass * speed * speed / (4 * stiffness), 0.4) /
           speed; // Johnson (1985), eq. 11.24
}

/// Speed after an impact on a plane over speed before. The contact begins a fraction `phase` of a
/// step before the first step with contact.
double rebound(LawName law, double restitution, Tension tension, double steps, double phase) {
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto grain = materials.add(bouncing(restitution));
    materials.policy.tension = tension;
    materials.mix();
    add_floor(world, grain);
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, grain);
    const double speed = 0.5, dt = contact_time(law, value_of<Mass>(world, ball), speed) / steps;
    value_of<Position>(world, ball) = Vec3(0, 0, radius + speed * dt * (10 - phase));
    value_of<Velocity>(world, ball) = Vec3(0, 0, -speed);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law});
    simulation.advance(static_cast<std::uint64_t>(20 * steps) +
                       20); // overdamped contacts part late
    return value_of<Velocity>(simulation, ball).z() / speed;
}

void add_restitution(StressRows& rows, LawName law, Tension tension) {
    // a 50th of the critical step 2/omega at the largest stiffness: omega t_c is pi for a linear
    // spring and, from the energies of a Hertz contact, 2.9433 sqrt(15/8) = 4.0302
    const double steps = 50 * (is_hertz(law) ? 4.0302 : pi) / 2;
    constexpr int phases = 16;
    for (const double e : {0.0, 0.01, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0}) {
        if (e == 0 && tension == Tension::calibrated) continue; // no dashpot is stiff enough
        double mean = 0, worst = 0;
        for (int k = 0; k < phases; ++k) {
            const double found = rebound(law, e, tension, steps, (k + 0.5) / phases);
            mean += found / phases;
            worst = std::max(worst, std::abs(found - e));
        }
        rows.push_back(
            {"S13",
             fmt::format("restitution {}, {}, tension {}", e, is_hertz(law) ? "Hertz" : "linear",
                         tension == Tension::allowed ? "allowed" : "calibrated"),
             "mean within 1e-3 at a 50th of the critical step",
             fmt::format("{:.5f} ({:+.1e}); largest error {:.1e} for any instant of first touch",
                         mean, mean - e, worst),
             std::abs(mean - e) < 1e-3});
    }
}

/// Largest relative change of the energy of a ball that bounces between two planes with e = 1.
double bouncing_error(LawName law, double steps, unsigned bounces) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(bouncing(1));
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, grain);
    const double speed = 0.5, time = contact_time(law, value_of<Mass>(world, ball), speed),
                 dt = time / steps, gap = 0.173 * speed * time;
    const EntityId host = add_boundary(world, Vec3::Zero(), grain);
    add_plane(world, host, Vec3(0, 0, -radius - gap / 2), Vec3::UnitZ());
    add_plane(world, host, Vec3(0, 0, radius + gap / 2), -Vec3::UnitZ());
    value_of<Velocity>(world, ball) = Vec3(0, 0, speed);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law});
    const auto each = static_cast<std::uint64_t>(1.173 * steps); // a flight and a contact
    double worst = 0;
    for (unsigned k = 0; k < bounces; ++k) {
        simulation.advance(each);
        for (std::uint64_t more = 0;
             more < 2 * each && value_of<Acceleration>(simulation, ball).z() != 0; ++more)
            simulation.advance(1);
        worst = std::max(
            worst,
            std::abs(value_of<Velocity>(simulation, ball).squaredNorm() / (speed * speed) - 1));
    }
    return worst;
}

void add_bounces(StressRows& rows, const StressSettings& s) {
    const unsigned bounces = s.full ? 10'000 : 500;
    for (const LawName law : {LawName::linear_frictionless, LawName::hertz_frictionless}) {
        const double coarse = bouncing_error(law, 50, bounces),
                     fine = bouncing_error(law, 200, bounces);
        // each bounce has an error of fourth order in dt, 1.4e-8 of the energy at a 200th of the
        // contact time, always of the same sign
        const double bound = 4e-8 * bounces;
        rows.push_back(
            {"S13",
             fmt::format("{} bounces with e = 1, {}", bounces, is_hertz(law) ? "Hertz" : "linear"),
             fmt::format("energy within {:.0e} at a 200th of the contact time", bound),
             fmt::format("{:.1e}; {:.1e} at a 50th, order {:.1f}", fine, coarse,
                         std::log2(coarse / fine) / 2),
             fine < bound});
    }
}

/// A sphere placed on a floor with a speed v0 slides until it rolls: after 2/7 v0 / (mu g), at
/// 5/7 v0.
void add_friction(StressRows& rows) {
    for (const double mu : {0.0, 1e-3, 1e-2, 0.1, 0.5, 1.0, 10.0}) {
        World world = make_world(Grains::spheres);
        Material m = linear_material(kn, 0.8 * kn, mu, density);
        m.normal_damping = m.shear_damping = 5000;
        const auto grain = world.resource<Materials>().add(m);
        add_floor(world, grain);
        const double gravity = 9.81;
        const EntityId ball = add_sphere(world, Vec3::Zero(), radius, grain);
        value_of<Position>(world, ball) =
            Vec3(0, 0, radius - value_of<Mass>(world, ball) * gravity / kn);
        world.add_resource<Gravity>({Vec3(0, 0, -gravity)});
        const double dt = 5e-6, slide = 4000 * dt,
                     speed = mu > 0 ? 3.5 * mu * gravity * slide : 0.1;
        value_of<Velocity>(world, ball) = Vec3(speed, 0, 0);
        Simulation simulation = begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
        simulation.advance(2000);
        const double halfway = value_of<Velocity>(simulation, ball).x() / speed,
                     exact_halfway = mu > 0 ? 1 - 1.0 / 7 : 1;
        simulation.advance(10'000);
        const double found = value_of<Velocity>(simulation, ball).x() / speed,
                     angular_velocity =
                         value_of<AngularVelocity>(simulation, ball).y() * radius / speed;
        const double exact = mu > 0 ? 5.0 / 7 : 1, exact_angular_velocity = mu > 0 ? 5.0 / 7 : 0;
        rows.push_back(
            {"S13", fmt::format("friction {}: from sliding to rolling", mu),
             fmt::format("v / v0 = {:.5f} halfway through sliding, then {:.5f} and rolling, within "
                         "1e-3",
                         exact_halfway, exact),
             fmt::format("{:.5f}, then {:.5f}, R omega / v0 = {:.5f}", halfway, found,
                         angular_velocity),
             std::abs(found - exact) < 1e-3 &&
                 std::abs(angular_velocity - exact_angular_velocity) < 1e-3 &&
                 std::abs(halfway - exact_halfway) < 1e-3});
    }
}

} // namespace

StressRows stress_restitution(const StressSettings& s) {
    StressRows rows;
    for (const LawName law : {LawName::linear_viscous, LawName::hertz_mindlin_viscous})
        for (const Tension tension : {Tension::allowed, Tension::calibrated})
            add_restitution(rows, law, tension);
    add_bounces(rows, s);
    add_friction(rows);
    return rows;
}

} // namespace bris
