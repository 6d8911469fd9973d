#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/random.hpp"
#include "engine/simulation.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/build/mass_properties.hpp"
#include "systems/build/scene.hpp"
#include "systems/output/contacts.hpp"
#include "systems/steps.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

// Small scenes that tests share.

namespace bris::testing {

/// The value of a component of a body, found by id.
template <class C> typename C::Value& of(World& world, EntityId body) {
    return world.column<Bodies, C>()[row_of_body(world, body)];
}
template <class C> typename C::Value& of(Simulation& simulation, EntityId body) {
    return of<C>(simulation.world(), body);
}

inline std::uint32_t add_material(World& world, const Material& material) {
    return world.resource<Materials>().add(material);
}

/// A material of which two partners have a contact of stiffness `kn`, `ks` (they act in series).
inline Material contact_material(double kn, double ks = 0, double friction = 0, double density = 2600) {
    return {.name = "grain", .density = density, .normal_stiffness = 2 * kn, .shear_stiffness = 2 * ks, .friction = friction};
}

struct RunSettings {
    double dt = 1e-5;
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {};
};

/// Adds the lists and the steps to a scene that is complete.
inline Simulation start(World world, const RunSettings& s) {
    world.resource<Clock>().dt = s.dt;
    add_lists(world, s.law, s.lists);
    Simulation simulation(std::move(world), steps(s.law), s.threads, s.schedule);
    simulation.on_restore(invalidate_lists);
    return simulation;
}

/// A plane z = 0 on a fixed body, grains above.
inline EntityId add_floor(World& world, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material);
    add_plane(world, host, Vec3::Zero(), Vec3(0, 0, 1));
    return host;
}

/// The square [low, high]^2 at z = 0 as n x n facets of one fixed body, normals up.
inline EntityId add_facet_floor(World& world, double low, double high, int n, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const auto at = [&](int i) { return low + (high - low) * i / n; };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            add_facet(world, host, {{Vec3(at(i), at(j), 0), Vec3(at(i + 1), at(j), 0), Vec3(at(i + 1), at(j + 1), 0),
                                     Vec3(at(i), at(j + 1), 0)}});
    return host;
}

/// The same square as two triangles, cut along the diagonal from the low corner.
inline EntityId add_triangle_floor(World& world, double low, double high, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const Vec3 a(low, low, 0), b(high, low, 0), c(high, high, 0), d(low, high, 0);
    add_facet(world, host, {{a, b, c, c}});
    add_facet(world, host, {{a, c, d, d}});
    return host;
}

/// A box of facets, each side cut into n x n, grains inside.
inline EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, int n, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, high.norm() + low.norm());
    const auto side = [&](const Vec3& corner, const Vec3& u, const Vec3& v) { // normal u x v
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const auto at = [&](int a, int b) -> Vec3 { return corner + u * a / n + v * b / n; };
                add_facet(world, host, {{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}});
            }
    };
    const Vec3 d = high - low, x = d.x() * Vec3::UnitX(), y = d.y() * Vec3::UnitY(), z = d.z() * Vec3::UnitZ();
    side(low, x, y);
    side(low, y, z);
    side(low, z, x);
    side(high, -y, -x);
    side(high, -z, -y);
    side(high, -x, -z);
    return host;
}

/// Six overlapping balls of a rock, about 1 m across.
inline Clump small_rock() {
    const std::vector<Ball> balls{{{0.25, 0, 0}, 0.3},    {{-0.25, 0.05, 0}, 0.28}, {{0, 0.2, 0.02}, 0.27},
                                  {{0.02, -0.2, 0}, 0.25}, {{0, 0.03, 0.16}, 0.26}, {{0.05, 0, -0.14}, 0.24}};
    return make_clump("small rock", balls);
}

enum class Walls { planes, facets };

/// What a bed is made of.
struct BedSettings {
    Grains grains = Grains::spheres;
    Walls walls = Walls::planes;
    unsigned bodies = 100;
    std::uint64_t seed = 1;
};

/// Grains of radius about 1 cm on a lattice, thrown about, in a box that they settle in; friction on.
inline World bed(const BedSettings& s) {
    World world = make_world(s.grains);
    Material material = contact_material(1e5, 3e4, 0.5);
    material.normal_damping = 1500;
    material.shear_damping = 750;
    const auto grain = add_material(world, material);
    const auto wall = add_material(world, {.name = "wall", .normal_stiffness = 4e5, .shear_stiffness = 1e5, .friction = 0.3,
                                           .normal_damping = 1000, .shear_damping = 500});
    const int n = static_cast<int>(std::ceil(std::cbrt(s.bodies * 0.5)));
    const double pitch = 0.0187;
    Random random(s.seed, 7);
    const Clump rock = s.grains == Grains::clumps ? small_rock() : Clump{};
    for (unsigned made = 0; made < s.bodies; ++made) {
        const auto i = static_cast<int>(made);
        const Vec3 site((i % n + 0.5) * pitch, (i / n % n + 0.5) * pitch, (i / n / n + 0.5) * pitch);
        const Vec3 place = site + 0.0003 * random.direction();
        EntityId id = 0;
        if (s.grains == Grains::spheres) {
            id = add_sphere(world, place, 0.0091 * random.uniform(0.75, 1), grain);
        } else {
            const Clump sized = scaled(rock, 0.0091 / rock.bounding_radius * random.uniform(0.8, 1));
            id = add_clump(world, sized, 0, place, random.rotation(), grain);
        }
        of<Velocity>(world, id) = 0.4 * random.direction() + Vec3(0, 0, -0.5);
        set_spin(world, id, 20 * random.direction());
    }
    const Vec3 high(n * pitch, n * pitch, 4 * n * pitch);
    if (s.walls == Walls::planes) add_box(world, Vec3::Zero(), high, wall);
    else add_facet_box(world, Vec3::Zero(), high, 4, wall);
    world.add_resource<Gravity>({Vec3(3, 2, -60)}); // settles soon, and into a corner
    return world;
}

/// A specimen without platens' friction: a membrane of `rings` x `sectors` elements about z, driven by
/// a servo, closed by two planes.
struct TubeSettings {
    unsigned rings = 2, sectors = 8;
    double radius = 0.05, height = 0.1, pressure = 1e4;
    double contact_stiffness = 1e5; ///< N/m, of a grain on an element
};

inline void add_tube(World& world, const TubeSettings& s, std::uint32_t material) {
    Membrane membrane;
    membrane.rings = s.rings;
    membrane.sectors = s.sectors;
    membrane.ring_height = s.height / s.rings;
    membrane.target_pressure = s.pressure;
    membrane.contact_stiffness = s.contact_stiffness;
    membrane.largest_step = 1e-4 * s.radius;
    add_membrane(world, std::move(membrane), s.radius, material);
    const EntityId bottom = add_boundary(world, Vec3::Zero(), material);
    const EntityId top = add_boundary(world, Vec3(0, 0, s.height), material, Motion::servo);
    add_plane(world, bottom, Vec3::Zero(), Vec3(0, 0, 1));
    Platen platen;
    platen.plane = add_plane(world, top, Vec3::Zero(), Vec3(0, 0, -1));
    world.add_resource(platen);
}

/// log2 of how much the error shrinks when the step is halved.
inline double order_of(double coarse_error, double fine_error) { return std::log2(coarse_error / fine_error); }

} // namespace bris::testing
