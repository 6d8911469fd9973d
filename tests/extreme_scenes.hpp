#pragma once

#include "engine/random.hpp"
#include "tests/support.hpp"

#include <array>
#include <cmath>

namespace bris::testing {

/// A scene of extreme ratios, and how it is simulated.
struct ExtremeScene {
    World world;
    SmallSceneSettings settings = {};
    bool on_floor = false; ///< otherwise nothing but grains is in the scene
    std::uint64_t steps = 1;
};

/// Balls along x, each among smaller grains that touch it, with random speeds, sizes, densities,
/// stiffnesses, dashpots, laws and steps, each over orders of magnitude.
inline ExtremeScene extreme_scene(std::uint64_t number) {
    static const Clump rock = scaled(small_rock(), 1 / small_rock().bounding_radius);
    Random draw(62, number);
    const auto log_uniform = [&](double low, double high) {
        return low * std::pow(high / low, draw.uniform());
    };
    const auto one_of = [&](unsigned count) {
        return static_cast<std::uint32_t>(draw.uniform() * count);
    };
    const bool clumps = draw.uniform() < 0.3, weighed = draw.uniform() < 0.7;
    ExtremeScene scene{.world = make_world(clumps ? Grains::clumps : Grains::spheres)};
    World& world = scene.world;
    // where nothing weighs, single spheres are moved by another system
    if (weighed) world.add_resource<Gravity>({Vec3::Zero()});
    const double stiffness = log_uniform(1e1, 1e10);
    auto& materials = world.resource<Materials>();
    materials.policy.tension = draw.uniform() < 0.5 ? Tension::allowed : Tension::cut;
    materials.policy.shear_dashpot = draw.uniform() < 0.5;
    for (int k = 0; k < 2; ++k)
        materials.add(
            {.name = "extreme",
             .density = log_uniform(1, 1e5),
             .normal_stiffness = stiffness * log_uniform(0.1, 10),
             .shear_stiffness = stiffness * draw.uniform(),
             .friction = draw.uniform() < 0.5 ? 0 : log_uniform(0.1, 10),
             .normal_damping = draw.uniform() < 0.5 ? 0 : log_uniform(1, 1e7),
             .shear_damping = draw.uniform() < 0.5 ? 0 : log_uniform(1, 1e7),
             .restitution = draw.uniform() < 0.3 ? 1 : log_uniform(1e-3, 1),
             .young_modulus = stiffness * log_uniform(1, 100),
             .poisson_ratio = 0.3,
             .rolling_friction = draw.uniform(),
             .twisting_friction = draw.uniform(),
             .contact_strength = draw.uniform() < 0.3 ? 0 : log_uniform(1e-4, 1e-1) * stiffness,
             .cone_half_angle = draw.uniform(0.1, 1.3),
             .edge_radius = draw.uniform() < 0.3 ? 0 : log_uniform(1e-4, 1),
             .friction_rise = draw.uniform() < 0.5 ? 0 : log_uniform(0.1, 10),
             .friction_half_pressure = log_uniform(1e-3, 1) * stiffness,
             .friction_half_force = log_uniform(1e-6, 1e3),
             .couple_arm = draw.uniform() < 0.3 ? 0 : log_uniform(1e-4, 1),
             .couple_force = log_uniform(1e-6, 1e3)});
    const double ball = log_uniform(1e-3, 10), ratio = log_uniform(1, 100), grain = ball / ratio,
                 density = materials.list[1].density,
                 mass = 4 * density * grain * grain * grain, // of a grain
        speed = draw.uniform() < 0.1
                    ? 0 // else relative to that at which the ball would enter a grain
                    : log_uniform(1e-3, 1e4) * grain * std::sqrt(stiffness / mass);
    scene.on_floor = draw.uniform() < 0.4;
    if (scene.on_floor && draw.uniform() < 0.5)
        add_facet_floor(world, -2 * ball, 20 * ball, 3, one_of(2));
    else if (scene.on_floor)
        add_floor(world, one_of(2));
    const unsigned balls = 1 + one_of(4),
                   grains = 2 + one_of(static_cast<unsigned>(std::min(150.0, 1 + ratio * ratio)));
    const auto push = [&](EntityId id, const Vec3& v) {
        value_of<Velocity>(world, id) = v;
        set_angular_velocity(world, id, log_uniform(1e-3, 1) * v.norm() / ball * draw.direction());
    };
    for (unsigned k = 0; k < balls; ++k) {
        const Vec3 centre(5 * ball * k, 0, 0.999 * ball);
        push(add_sphere(world, centre, ball, 0), speed * draw.direction());
        for (unsigned g = 0; g < grains; ++g) {
            const double radius = grain * draw.uniform(0.5, 1), up = (g + 0.5) / grains,
                         z = scene.on_floor ? up : 2 * up - 1, across = std::sqrt(1 - z * z),
                         turn = pi * (3 - std::sqrt(5.0)) * g;
            const Vec3 at = centre + (ball + radius * draw.uniform(0.9, 1.01)) *
                                         Vec3(across * std::cos(turn), across * std::sin(turn), z);
            const EntityId id =
                clumps && draw.uniform() < 0.5
                    ? add_clump(world, scaled(rock, radius), 0, at, draw.rotation(), 1)
                    : add_sphere(world, at, radius, 1);
            push(id, speed * draw.uniform() * draw.direction());
        }
    }
    scene.settings = {
        .dt = log_uniform(1e-6, 0.1) * (speed > 0 ? grain / speed : std::sqrt(mass / stiffness)),
        .law = static_cast<LawName>(one_of(static_cast<unsigned>(texts_of(LawName{}).size()))),
        .threads = 1 + one_of(2),
        .energy_budget = draw.uniform() < 0.2,
        .unlimited = draw.uniform() < 0.8};
    scene.steps = 1 + one_of(4);
    return scene;
}

} // namespace bris::testing
