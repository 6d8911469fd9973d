#include "tests/verification/rest.hpp"

#include "components/settings.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "systems/output/stress.hpp"

#include <cmath>

namespace bris {

RestResult run_experiment(const SmallBetweenLarge& s) {
    constexpr double radius = 1e-3, kn = 1e4, g = 9.81;
    World world = make_world(Grains::spheres);
    Material m = linear_material(kn, 0.8 * kn, s.friction);
    const double mass = m.density * 4 / 3 * pi * radius * radius * radius,
                 omega = std::sqrt(kn / mass);
    m.normal_damping = m.shear_damping = 0.5 * omega;
    const auto material = world.resource<Materials>().add(m);
    const double large = s.ratio * radius, reach = large + radius;
    for (const double x : {-large, large})
        add_sphere(world, Vec3(x, 0, 0), large, material, Motion::fixed);
    // the small sphere begins on one of the large ones and rolls down into the groove
    const double x = s.offset * radius, z = std::sqrt(reach * reach - (large + x) * (large + x));
    const EntityId small = add_sphere(
        world, Vec3(-x, 0, std::max(z, std::sqrt(reach * reach - (large - x) * (large - x)))),
        radius, material);
    world.add_resource<Gravity>({Vec3(0, 0, -g)});
    const double dt = 0.1 / omega;
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous, .unlimited = true});
    const auto steps = static_cast<std::uint64_t>(60 * std::sqrt(radius / g) / dt);
    sim.advance(steps - steps / 10);
    const Vec3 before = value_of<Position>(sim, small);
    sim.advance(steps / 10);
    RestResult r;
    r.speed = value_of<Velocity>(sim, small).norm() / std::sqrt(g * radius);
    r.angular_velocity = value_of<AngularVelocity>(sim, small).norm() * std::sqrt(radius / g);
    r.travel = (value_of<Position>(sim, small) - before).norm() / radius;
    r.unbalanced = value_of<Force>(sim, small).norm() / (mass * g);
    return r;
}

TripodResult run_experiment(const Tripod& s) {
    constexpr double radius = 0.01, kn = 1e6, g = 9.81;
    Clump clump;
    clump.volume = 1e-4;
    clump.inertia = Vec3(0.4, 0.4, 0.5) * clump.volume * radius * radius;
    clump.bounding_radius = (3 + s.height) * radius;
    clump.balls.push_back({Vec3::Zero(), 1.5 * radius});
    for (int k = 0; k < 3; ++k)
        clump.balls.push_back(
            {radius * Vec3(2 * std::cos(2 * pi * k / 3), 2 * std::sin(2 * pi * k / 3), -s.height),
             radius});
    World world = make_world(Grains::clumps);
    Material m = linear_material(kn, 0.8 * kn, 0.5);
    const double mass = m.density * clump.volume, omega = std::sqrt(3 * kn / mass);
    m.normal_damping = m.shear_damping = 0.2 * omega;
    const auto material = world.resource<Materials>().add(m);
    const double touching = (1 + s.height) * radius;
    const EntityId body =
        add_clump(world, clump, 0, Vec3(0, 0, touching), Quat(Quat::Identity()), material);
    add_floor(world, material);
    world.add_resource<Gravity>({Vec3(0, 0, -g)});
    Simulation sim = begin(std::move(world),
                           {.dt = 0.05 / omega, .law = LawName::linear_viscous, .unlimited = true});
    sim.advance(20000);
    TripodResult r;
    r.overlap = (touching - value_of<Position>(sim, body).z()) * 3 * kn / (mass * g);
    r.tilt = value_of<Orientation>(sim, body).angularDistance(Quat(Quat::Identity()));
    r.floor_force = compute_quantities(sim.world()).boundary_force_over_weight();
    return r;
}

PackingResult run_experiment(const Packing& s) {
    constexpr double radius = 0.01, kn = 1e5;
    World world = make_world(Grains::spheres);
    Material m = linear_material(kn, 0.8 * kn, 0.5);
    const double omega = std::sqrt(kn / (m.density * 4 / 3 * pi * radius * radius * radius));
    m.normal_damping = m.shear_damping =
        0.2 * omega; // six contacts per sphere, times 5/2 for its rotation, stay below 2 / dt
    const auto material = world.resource<Materials>().add(m);
    const double pitch = 2.05 * radius;
    for (unsigned i = 0; i < s.side * s.side * s.side; ++i) {
        Random random(s.seed, i);
        const Vec3 site =
            pitch * Vec3(i % s.side + 0.5, i / s.side % s.side + 0.5, i / s.side / s.side + 0.5);
        add_sphere(world, site + 0.02 * radius * random.direction(),
                   radius * random.uniform(0.8, 1), material);
    }
    add_box(world, Vec3::Zero(), pitch * Vec3(s.side, s.side, 3 * s.side), material);
    world.add_resource<Gravity>();
    world.add_resource(LocalDamping{0.5}); // damps free rolling, which no contact damps
    Simulation sim = begin(std::move(world),
                           {.dt = 0.1 / omega, .law = LawName::linear_viscous, .unlimited = true});
    PackingResult r;
    for (int k = 0; k < 60; ++k) {
        sim.advance(1000);
        const Quantities q = compute_quantities(sim.world());
        r.unbalanced_ratio = q.unbalanced_ratio;
        r.floor_force_error = std::abs(q.boundary_force_over_weight() - 1);
        r.coordination = q.coordination;
        if (r.unbalanced_ratio < 1e-12) break;
    }
    r.stress_mismatch = compute_stresses(sim.world()).mismatch();
    return r;
}

} // namespace bris
