#include "scenarios/specimens/small_scene.hpp"

#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/sleeve.hpp"
#include "scenarios/specimens/start.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace bris {

namespace {
constexpr double tumble_pitch = 0.0187; // m, of the places at the start
} // namespace

Simulation begin(World world, const SmallSceneSettings& s) {
    world.resource<Clock>().dt = s.dt;
    if (s.unlimited) {
        Limits& limits = world.resource<Limits>();
        limits.overlap = 2; // of the mean radius: one sphere within the other
        limits.speed = std::numeric_limits<double>::max();
    }
    ScheduleSettings schedule = s.schedule;
    schedule.least_rows = 0;
    return start_unchecked(std::move(world), {.law = s.law,
                                              .threads = s.threads,
                                              .lists = s.lists,
                                              .schedule = schedule,
                                              .energy_budget = s.energy_budget});
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

EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, int n,
                       std::uint32_t material) {
    const EntityId host =
        add_boundary(world, Vec3::Zero(), material, Motion::fixed, high.norm() + low.norm());
    for_sides_of_box(low, high, [&](const Vec3& corner, const Vec3& u, const Vec3& v) {
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const auto at = [&](int a, int b) -> Vec3 {
                    return corner + u * a / n + v * b / n;
                };
                add_facet(world, host, {{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}});
            }
    });
    return host;
}

EntityId add_facet_floor(World& world, double low, double high, int n, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const auto at = [&](int i) { return low + (high - low) * i / n; };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            add_facet(world, host,
                      {{Vec3(at(i), at(j), 0), Vec3(at(i + 1), at(j), 0),
                        Vec3(at(i + 1), at(j + 1), 0), Vec3(at(i), at(j + 1), 0)}});
    return host;
}

EntityId add_triangle_floor(World& world, double low, double high, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const Vec3 a(low, low, 0), b(high, low, 0), c(high, high, 0), d(low, high, 0);
    add_facet(world, host, {{a, b, c, c}});
    add_facet(world, host, {{a, c, d, d}});
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

World bed(const SmallBed& s) {
    const Tumble tumble{
        .grains = s.grains, .bodies = s.bodies, .seed = s.seed, .walls = s.walls == Walls::planes};
    World world = tumbling(tumble);
    if (s.walls == Walls::facets) add_facet_box(world, Vec3::Zero(), box_of(tumble), 4, 1);
    return world;
}

void add_tube(World& world, const TubeSettings& s, std::uint32_t material) {
    Membrane membrane;
    membrane.rings = s.rings;
    membrane.sectors = s.sectors;
    membrane.ring_height = s.height / s.rings;
    membrane.target_pressure = s.pressure;
    membrane.contact_stiffness = s.contact_stiffness;
    membrane.largest_step = 1e-4 * s.radius;
    if (s.latex)
        add_sleeve(world, std::move(membrane), {},
                   {3 * s.sectors, 4 * s.rings + 1, s.sectors, s.radius, s.height}, material);
    else
        add_membrane(world, std::move(membrane), s.radius, material);
    const EntityId bottom = add_boundary(world, Vec3::Zero(), material);
    const EntityId top = add_boundary(world, Vec3(0, 0, s.height), material, Motion::servo);
    add_plane(world, bottom, Vec3::Zero(), Vec3(0, 0, 1));
    Platen platen;
    platen.plane = add_plane(world, top, Vec3::Zero(), Vec3(0, 0, -1));
    world.add_resource(platen);
}

Touch touch_of(const World& world) {
    Touch t;
    for_each_kind_of_pair([&]<class Pairs>() {
        for (const TouchingPair& p : touching_pairs<Pairs>(world)) {
            const Vec3 force(p.force.fx, p.force.fy, p.force.fz);
            ++t.pairs;
            t.overlap = std::max(t.overlap, p.force.overlap);
            t.normal_force += p.force.normal_force;
            t.force += force;
            t.spring = p.spring;
            const double n = p.force.normal_force,
                         shear = std::sqrt(std::max(0.0, force.squaredNorm() - n * n));
            if (n > 0) t.friction_ratio = std::max(t.friction_ratio, shear / n);
        }
    });
    return t;
}

double free_kinetic_energy(World& world, EntityId body) {
    const Vec3& w = value_of<AngularVelocity>(world, body);
    return 0.5 *
           (value_of<InertialMass>(world, body) * value_of<Velocity>(world, body).squaredNorm() +
            w.dot(angular_momentum(world, body, w)));
}

} // namespace bris
