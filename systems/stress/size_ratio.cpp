// S8: small bodies between large ones, light ones under heavy ones.
#include "systems/output/quantities.hpp"
#include "systems/procedure/equilibrium.hpp"
#include "systems/stress/cases.hpp"
#include "systems/stress/scenes.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

using namespace stress;

// The trap of three bodies (Vyas et al. 2025): a small sphere in the groove between two large, fixed ones that touch each
// other. With static friction it rolls out of the groove, on a circle of radius rho around the line of their centres, with
// angular acceleration g rho sin(angle) / (rho^2 + 2/5 (R + r)^2): its spin is (R + r) / r times that of its centre. Normals
// and velocities of different times act as a friction that holds it.
struct Groove {
    double ratio;
    static constexpr double small = 0.01, gravity = 10, begin = 0.5; // m, m/s2, rad from the top
    double large() const { return ratio * small; }
    double rho() const { return std::sqrt((large() + small) * (large() + small) - large() * large()); }
    double rate2() const { return gravity * rho() / (rho() * rho() + 0.4 * (large() + small) * (large() + small)); }

    /// Angle of the rigid rolling sphere at a time (Runge-Kutta, 1000 steps: error below 1e-12).
    double rigid(double time) const {
        double angle = begin, speed = 0;
        const double h = time / 1000;
        for (int k = 0; k < 1000; ++k) {
            const auto acceleration = [&](double a) { return rate2() * std::sin(a); };
            const double k1 = acceleration(angle), k2 = acceleration(angle + 0.5 * h * speed), k3 = acceleration(angle + 0.5 * h * speed + 0.25 * h * h * k1),
                         k4 = acceleration(angle + h * speed + 0.5 * h * h * k2);
            angle += h * speed + h * h / 6 * (k1 + k2 + k3);
            speed += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        return angle;
    }
};

/// Angle of the small sphere at `time` with steps of time / `steps`.
double rolled(const Groove& g, LawName law, double time, std::uint64_t steps) {
    World world = make_world(Grains::spheres);
    const double mass = 2600 * 4 * pi / 3 * std::pow(Groove::small, 3);
    const double normal = 0.5 * mass * Groove::gravity * std::cos(Groove::begin) * (g.large() + Groove::small) / g.rho();
    const double kn = normal / (1e-4 * Groove::small); // overlap of 1e-4 radii
    const auto grain = world.resource<Materials>().add(grain_material(kn, 0.8 * kn, 1));
    for (const double side : {-1.0, 1.0}) add_sphere(world, Vec3(side * g.large(), 0, 0), g.large(), grain, Motion::fixed);
    const double reach = g.large() + Groove::small * (1 - 1e-4), circle = std::sqrt(reach * reach - g.large() * g.large());
    const EntityId ball = add_sphere(world, circle * Vec3(0, std::sin(Groove::begin), std::cos(Groove::begin)), Groove::small, grain);
    world.add_resource<Gravity>({Vec3(0, 0, -Groove::gravity)});
    world.resource<Limits>().overlap = 1;
    const double dt = time / static_cast<double>(steps);
    // at rest at t = 0: half a step back the velocity is that of the acceleration down the groove
    const Vec3 down(0, std::cos(Groove::begin), -std::sin(Groove::begin));
    const double turning = g.rate2() * std::sin(Groove::begin);
    of<Velocity>(world, ball) = -0.5 * dt * turning * g.rho() * down;
    of<AngularMomentum>(world, ball) = -0.5 * dt * of<SphereInertia>(world, ball) * turning * (g.large() + Groove::small) / Groove::small * Vec3(-1, 0, 0);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law, .schedule = {.serial = true}});
    simulation.advance(steps);
    const Vec3& x = of<Position>(simulation, ball);
    return std::atan2(x.y(), x.z());
}

void add_trap(StressRows& rows, double ratio, LawName law, bool full) {
    const Groove g{ratio};
    const double time = 0.6 / std::sqrt(g.rate2());
    // the first run has 20 steps a radian of the contact's vibration
    const double mass = 2600 * 4 * pi / 3 * std::pow(Groove::small, 3);
    const double kn = 0.5 * mass * Groove::gravity * std::cos(Groove::begin) * (g.large() + Groove::small) / g.rho() / (1e-4 * Groove::small);
    const auto coarse = static_cast<std::uint64_t>(20 * time * std::sqrt(kn / mass));
    const double reference = rolled(g, law, time, coarse * (full ? 32 : 16));
    const double error = std::abs(rolled(g, law, time, coarse) - reference), finer = std::abs(rolled(g, law, time, 2 * coarse) - reference);
    const double rigid = g.rigid(time) - Groove::begin, gone = reference - Groove::begin;
    const std::string what = fmt::format("trap of three, 1:{:g}, {}", ratio, law == LawName::linear ? "springs" : "springs and dashpots");
    rows.push_back({"S8", what + ": leaves", "as a rigid sphere that rolls, within 1 %", fmt::format("{:.5f} of {:.5f} rad", gone, rigid), std::abs(gone / rigid - 1) < 0.01});
    const double order = std::log2(error / finer);
    rows.push_back({"S8", what + ": error", "order 2 in dt (1.7 to 3), or below 1e-7 of the way",
                    fmt::format("{:.1e} and {:.1e} of the way, order {:.2f}", error / gone, finer / gone, order),
                    (order > 1.7 && order < 3) || error < 1e-7 * gone});
}

/// A sphere ten times as large and a thousand times as dense as the bed that it lies on: mass ratio 1e6.
void add_heavy_on_light(StressRows& rows, unsigned small, std::uint64_t longest) {
    constexpr double radius = 0.005, width = 0.12;
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto light = materials.add(grain_material(1e6, 3e5, 0.5)), heavy = materials.add(grain_material(1e6, 3e5, 0.5, 2600e3));
    for (unsigned k = 0; k < small; ++k)
        add_sphere(world, Vec3(0.0105 * (k % 11 + 0.6), 0.0105 * (k / 11 % 11 + 0.6), 0.0105 * (k / 121 + 0.5)), radius, light);
    const EntityId ball = add_sphere(world, Vec3(width / 2, width / 2, 0.0105 * (small / 121 + 1) + 0.051), 10 * radius, heavy);
    add_box(world, Vec3::Zero(), Vec3(width, width, 1), light);
    world.add_resource<Gravity>({Vec3(0, 0, -0.5)});
    world.add_resource(LocalDamping{0.7});
    const double dt = 0.2 * std::sqrt(of<Mass>(world, 0) / 1e6); // a dozen contacts of a light sphere
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = LawName::linear});
    const std::string refusal = refusal_of([&] { find_equilibrium(simulation, {.ratio = 1e-4, .longest = longest}); });
    const Quantities q = measure(simulation.world());
    const double carried = q.boundary_force.z() / q.weight.z(), height = of<Position>(simulation, ball).z();
    rows.push_back({"S8", fmt::format("a sphere on {} a million times lighter", small), "at rest, floor force = weight within 0.1 %, does not sink in",
                    refusal.empty() ? fmt::format("force / weight {:.5f}, {:.1f} light diameters above the floor", carried, (height - 10 * radius) / (2 * radius)) : refusal,
                    refusal.empty() && std::abs(carried - 1) < 1e-3 && height > 10 * radius});
}

} // namespace

StressRows stress_size_ratio(const StressSettings& s) {
    StressRows rows;
    for (const double ratio : {3.0, 10.0, 50.0})
        for (const LawName law : {LawName::linear, LawName::linear_viscous}) add_trap(rows, ratio, law, s.full);
    if (s.full)
        for (const LawName law : {LawName::linear, LawName::linear_viscous}) add_trap(rows, 100, law, true);
    add_heavy_on_light(rows, s.full ? 484 : 242, s.full ? 1'000'000 : 100'000);
    return rows;
}

} // namespace bris
