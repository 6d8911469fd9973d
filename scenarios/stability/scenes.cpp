#include "scenarios/stability/scenes.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/triaxial/equilibrium.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/steps.hpp"

#include <array>
#include <cmath>

namespace bris::stress {

namespace {
constexpr double tumble_pitch = 0.0187; // m, spacing of the initial positions
} // namespace

Simulation begin(World world, const Setup& s) {
    world.resource<Clock>().dt = s.dt;
    add_lists(world, s.law, s.lists);
    if (s.energy_budget) add_energy_budget(world);
    ScheduleSettings schedule = s.schedule;
    schedule.least_rows = 0; // use threads although the scene is small
    Simulation simulation(std::move(world), steps(s.law, s.energy_budget), s.threads, schedule);
    simulation.on_restore(forget_lists);
    return simulation;
}

EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material) {
    const EntityId host =
        add_boundary(world, Vec3::Zero(), material, Motion::fixed, high.norm() + low.norm());
    for_sides_of_box(low, high, [&](const Vec3& corner, const Vec3& u, const Vec3& v) {
        add_facet(world, host, {{corner, corner + u, corner + u + v, corner + u + v}});
        add_facet(world, host, {{corner, corner + u + v, corner + v, corner + v}});
    });
    return host;
}

Clump small_rock() {
    const std::array<Ball, 6> balls{{{{0.25, 0, 0}, 0.3},
                                     {{-0.25, 0.05, 0}, 0.28},
                                     {{0, 0.2, 0.02}, 0.27},
                                     {{0.02, -0.2, 0}, 0.25},
                                     {{0, 0.03, 0.16}, 0.26},
                                     {{0.05, 0, -0.14}, 0.24}}};
    return make_clump("small rock", balls);
}

Vec3 box_of(const Tumble& t) {
    const double side = tumble_pitch * t.units.length * std::ceil(std::cbrt(t.bodies * 0.5));
    return {side, side, 4 * side};
}

World tumbling(const Tumble& t) {
    World world = make_world(t.grains);
    const double length = t.units.length, time = t.units.time,
                 stiffness = t.units.mass / (time * time);
    Material material = linear_material(1e5 * stiffness, 3e4 * stiffness, 0.5,
                                        2600 * t.units.mass / (length * length * length));
    material.normal_damping = 1500 / time;
    material.shear_damping = 750 / time;
    const auto grain = world.resource<Materials>().add(material);
    Material wall_material;
    wall_material.name = "wall";
    wall_material.normal_stiffness = 4e5 * stiffness;
    wall_material.shear_stiffness = 1e5 * stiffness;
    wall_material.friction = 0.3;
    wall_material.normal_damping = 1000 / time;
    wall_material.shear_damping = 500 / time;
    const auto wall = world.resource<Materials>().add(wall_material);
    const int n = static_cast<int>(std::ceil(std::cbrt(t.bodies * 0.5)));
    const double pitch = tumble_pitch * length;
    Random random(t.seed, 7);
    const Clump rock = t.grains == Grains::clumps ? small_rock() : Clump{};
    for (unsigned made = 0; made < t.bodies; ++made) {
        const auto i = static_cast<int>(made);
        const Vec3 site((i % n + 0.5) * pitch, (i / n % n + 0.5) * pitch,
                        (i / n / n + 0.5) * pitch);
        const Vec3 position = site + 0.0003 * length * random.direction();
        EntityId id = 0;
        if (t.grains == Grains::spheres) {
            id = add_sphere(world, position, 0.0091 * length * random.uniform(0.75, 1), grain);
        } else {
            const Clump sized =
                scaled(rock, 0.0091 * length / rock.bounding_radius * random.uniform(0.8, 1));
            id = add_clump(world, sized, 0, position, random.rotation(), grain);
        }
        value_of<Velocity>(world, id) =
            length / time * (0.4 * random.direction() + Vec3(0, 0, -0.5));
        set_angular_velocity(world, id, 20 / time * random.direction());
    }
    if (t.walls) add_box(world, Vec3::Zero(), box_of(t), wall);
    world.add_resource<Gravity>({length / (time * time) * Vec3(3, 2, -60)});
    world.resource<Limits>().speed *= length / time;
    return world;
}

Simulation bed_at_rest(const Tumble& t, double ratio, double ks_ratio) {
    World world = tumbling(t);
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) m.shear_stiffness = ks_ratio * m.normal_stiffness;
    materials.mix();
    world.add_resource(LocalDamping{0.7});
    Simulation simulation =
        begin(std::move(world), {.dt = 2e-5 * t.units.time, .law = LawName::linear});
    find_equilibrium(simulation, {.ratio = ratio, .longest = 200'000});
    return simulation;
}

std::string refusal_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const InputError& error) {
        return error.what();
    } catch (const SimulationError& error) {
        return error.what();
    }
    return "";
}

double mean_radius(const World& world) {
    const Table& bodies = world.table<Bodies>();
    double sum = 0, count = 0;
    for (Row b = 0; b < bodies.size(); ++b) {
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        sum += bodies.column<BoundingRadius>()[b];
        ++count;
    }
    return sum / count;
}

} // namespace bris::stress
