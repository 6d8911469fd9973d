// S8: small bodies between large ones and light bodies under heavy ones.
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

// The three-body trap (Vyas et al. 2025): a small sphere in the groove between two large fixed
// spheres that touch each other. With static friction it rolls out of the groove on a circle of
// radius rho around the line of their centres, with the angular acceleration
// g rho sin(angle) / (rho^2 + 2/5 (R + r)^2); its angular velocity is (R + r) / r times that of its
// centre. In a code that uses normals and velocities of different times, a spurious friction holds
// it.
struct Groove {
    double ratio;
    static constexpr double small = 0.01, gravity = 10, begin = 0.5; // m, m/s2, rad from vertical
    double large() const { return ratio * small; }
    double rho() const {
        return std::sqrt((large() + small) * (large() + small) - large() * large());
    }
    double rate2() const {
        return gravity * rho() / (rho() * rho() + 0.4 * (large() + small) * (large() + small));
    }

    /// Angle (rad) of a rigid rolling sphere at a time (s), by 1000 Runge-Kutta steps. Error below
    /// 1e-12.
    double rigid(double time) const {
        double angle = begin, speed = 0;
        const double h = time / 1000;
        for (int k = 0; k < 1000; ++k) {
            const auto acceleration = [&](double a) { return rate2() * std::sin(a); };
            const double k1 = acceleration(angle), k2 = acceleration(angle + 0.5 * h * speed),
                         k3 = acceleration(angle + 0.5 * h * speed + 0.25 * h * h * k1),
                         k4 = acceleration(angle + h * speed + 0.5 * h * h * k2);
            angle += h * speed + h * h / 6 * (k1 + k2 + k3);
            speed += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        return angle;
    }
};

/// Mean angle (rad) of the small sphere from 0.9 to 1 of `time` (s), with `steps` time steps in
/// `time`. The number of steps is a multiple of ten.
double rolled(const Groove& g, LawName law, double time, std::uint64_t steps) {
    World world = make_world(Grains::spheres);
    const double mass = 2600 * 4 * pi / 3 * std::pow(Groove::small, 3);
    const double normal = 0.5 * mass * Groove::gravity * std::cos(Groove::begin) *
                          (g.large() + Groove::small) / g.rho();
    const double kn = normal / (1e-4 * Groove::small); // overlap of 1e-4 radii
    Material material = linear_material(kn, 0.8 * kn, 1);
    if (has_dashpots(law))
        material.normal_damping = material.shear_damping = 0.1 * std::sqrt(kn / mass);
    const auto grain = world.resource<Materials>().add(material);
    for (const double side : {-1.0, 1.0})
        add_sphere(world, Vec3(side * g.large(), 0, 0), g.large(), grain, Motion::fixed);
    const double reach = g.large() + Groove::small * (1 - 1e-4),
                 circle = std::sqrt(reach * reach - g.large() * g.large());
    const EntityId ball =
        add_sphere(world, circle * Vec3(0, std::sin(Groove::begin), std::cos(Groove::begin)),
                   Groove::small, grain);
    world.add_resource<Gravity>({Vec3(0, 0, -Groove::gravity)});
    world.resource<Limits>().overlap = 1;
    const double dt = time / static_cast<double>(steps);
    // at rest at t = 0; the velocity at -dt/2 follows from the acceleration down the groove
    const Vec3 down(0, std::cos(Groove::begin), -std::sin(Groove::begin));
    const double turning = g.rate2() * std::sin(Groove::begin);
    value_of<Velocity>(world, ball) = -0.5 * dt * turning * g.rho() * down;
    value_of<AngularMomentum>(world, ball) = -0.5 * dt * value_of<SphereInertia>(world, ball) *
                                             turning * (g.large() + Groove::small) / Groove::small *
                                             Vec3(-1, 0, 0);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law});
    // the mean over the last tenth removes small vibrations of the contacts
    const std::uint64_t last = steps / 10;
    simulation.advance(steps - last);
    double sum = 0;
    for (std::uint64_t k = 0; k <= last; ++k) {
        const Vec3& x = value_of<Position>(simulation, ball);
        sum += (k == 0 || k == last ? 0.5 : 1) * std::atan2(x.y(), x.z());
        if (k < last) simulation.advance(1);
    }
    return sum / static_cast<double>(last);
}

void add_trap(StressRows& rows, double ratio, LawName law, bool full) {
    const Groove g{ratio};
    const double time = 0.6 / std::sqrt(g.rate2());
    // the first run has 4 steps per radian of the contact's vibration
    const double mass = 2600 * 4 * pi / 3 * std::pow(Groove::small, 3);
    const double kn = 0.5 * mass * Groove::gravity * std::cos(Groove::begin) *
                      (g.large() + Groove::small) / g.rho() / (1e-4 * Groove::small);
    const auto coarse = 10 * static_cast<std::uint64_t>(0.4 * time * std::sqrt(kn / mass));
    const double reference = rolled(g, law, time, coarse * (full ? 32 : 16));
    const double error = std::abs(rolled(g, law, time, coarse) - reference),
                 finer = std::abs(rolled(g, law, time, 2 * coarse) - reference);
    // Simpson's rule over the same tenth
    const double rigid = (g.rigid(0.9 * time) + 4 * g.rigid(0.95 * time) + g.rigid(time)) / 6 -
                         Groove::begin,
                 gone = reference - Groove::begin;
    const std::string what =
        fmt::format("three-body trap, size ratio 1:{:g}, {}", ratio,
                    law == LawName::linear ? "springs" : "springs and dashpots");
    rows.push_back({"S8", what + ": angle rolled", "that of a rigid rolling sphere within 1 %",
                    fmt::format("{:.5f} rad, rigid {:.5f} rad", gone, rigid),
                    std::abs(gone / rigid - 1) < 0.01});
    const double order = std::log2(error / finer);
    const std::string found = fmt::format("{:.1e} and {:.1e} of the angle, order {:.2f}",
                                          error / gone, finer / gone, order);
    // without dashpots the contacts keep vibrating with a phase that depends on the step: by at
    // most (omega dt)^2 of the overlap of 1e-4 radii, seen as an angle on a circle of radius rho
    const double vibration = 1.0 / 16 * 1e-4 * Groove::small / g.rho();
    if (law == LawName::linear)
        rows.push_back({"S8", what + ": error",
                        fmt::format("below {:.0e} of the angle, the vibration of the contacts",
                                    vibration / gone),
                        found, error < vibration});
    else
        rows.push_back({"S8", what + ": error", "order 2 in dt (1.8 to 2.5)", found,
                        order > 1.8 && order < 2.5});
}

/// A sphere ten times as large and a thousand times as dense lies on three light ones: mass ratio
/// 1e6. Without friction the light ones would roll out from under it. Friction holds them, because
/// the angle between the surfaces is less than twice the friction angle.
void add_heavy_on_light(StressRows& rows) {
    constexpr double radius = 0.005, stiffness = 1e6, gravity = 0.5;
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto light = materials.add(linear_material(stiffness, 3e5, 0.5)),
               heavy = materials.add(linear_material(stiffness, 3e5, 0.5, 2600e3));
    constexpr double beside = 1.5 * radius; // m, distance from the axis
    for (int k = 0; k < 3; ++k)
        add_sphere(
            world,
            Vec3(beside * std::cos(2 * pi * k / 3), beside * std::sin(2 * pi * k / 3), radius),
            radius, light);
    const EntityId ball =
        add_sphere(world, Vec3(0, 0, radius + std::sqrt(121 * radius * radius - beside * beside)),
                   10 * radius, heavy);
    add_floor(world, light);
    world.add_resource<Gravity>({Vec3(0, 0, -gravity)});
    world.add_resource(LocalDamping{0.7});
    const double dt = 0.2 * std::sqrt(value_of<Mass>(world, 0) / stiffness),
                 ratio = value_of<Mass>(world, ball) / value_of<Mass>(world, 0);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = LawName::linear});
    const std::string refusal =
        refusal_of([&] { find_equilibrium(simulation, {.ratio = 1e-5, .longest = 1'000'000}); });
    const Quantities q = compute_quantities(simulation.world());
    const double carried = q.boundary_force_over_weight(),
                 gone =
                     (value_of<Position>(simulation, 0) - Vec3(beside, 0, radius)).head<2>().norm();
    rows.push_back(
        {"S8", fmt::format("a heavy sphere on three light ones, mass ratio {:.3g}", ratio),
         "at rest, floor force = weight within 1e-4, light spheres held by friction",
         refusal.empty() ? fmt::format("force / weight {:.7f}, light spheres moved by {:.1e} radii",
                                       carried, gone / radius)
                         : refusal,
         refusal.empty() && std::abs(carried - 1) < 1e-4 && gone < 0.1 * radius});
}

} // namespace

StressRows stress_size_ratio(const StressSettings& s) {
    StressRows rows;
    for (const double ratio : {3.0, 10.0, 50.0})
        for (const LawName law : {LawName::linear, LawName::linear_viscous})
            add_trap(rows, ratio, law, s.full);
    if (s.full)
        for (const LawName law : {LawName::linear, LawName::linear_viscous})
            add_trap(rows, 100, law, true);
    add_heavy_on_light(rows);
    return rows;
}

} // namespace bris
