#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/random.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/stability/scenes.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/contacts.hpp"
#include "systems/steps.hpp"

#include <cmath>
#include <utility>

// Small scenes that several tests use.

namespace bris::testing {

using stress::small_rock;

inline std::uint32_t add_material(World& world, const Material& material) {
    return world.resource<Materials>().add(material);
}

struct RunSettings {
    double dt = 1e-5;
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {};
};

/// Adds the neighbour lists and the step list to a complete scene.
inline Simulation start(World world, const RunSettings& s) {
    world.resource<Clock>().dt = s.dt;
    add_lists(world, s.law, s.lists);
    ScheduleSettings schedule = s.schedule;
    // uses the threads even in a small scene, because they are what is tested
    schedule.least_rows = 0;
    Simulation simulation(std::move(world), steps(s.law), s.threads, schedule);
    simulation.on_restore(invalidate_lists);
    return simulation;
}

/// The square [low, high]^2 at z = 0 as n x n facets of one fixed body, with normals upwards.
inline EntityId add_facet_floor(World& world, double low, double high, int n,
                                std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const auto at = [&](int i) { return low + (high - low) * i / n; };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            add_facet(world, host,
                      {{Vec3(at(i), at(j), 0), Vec3(at(i + 1), at(j), 0),
                        Vec3(at(i + 1), at(j + 1), 0), Vec3(at(i), at(j + 1), 0)}});
    return host;
}

/// The same square as two triangles, divided along the diagonal from the low corner.
inline EntityId add_triangle_floor(World& world, double low, double high, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * high);
    const Vec3 a(low, low, 0), b(high, low, 0), c(high, high, 0), d(low, high, 0);
    add_facet(world, host, {{a, b, c, c}});
    add_facet(world, host, {{a, c, d, d}});
    return host;
}

/// A box of facets for grains inside it; each side is divided into n x n facets.
inline EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, int n,
                              std::uint32_t material) {
    const EntityId host =
        add_boundary(world, Vec3::Zero(), material, Motion::fixed, high.norm() + low.norm());
    stress::for_sides_of_box(low, high, [&](const Vec3& corner, const Vec3& u, const Vec3& v) {
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

enum class Walls { planes, facets };

/// Contents of a bed.
struct BedSettings {
    Grains grains = Grains::spheres;
    Walls walls = Walls::planes;
    unsigned bodies = 100;
    std::uint64_t seed = 1;
};

/// Grains with a radius of about 1 cm that start on a lattice with random velocities and settle in
/// a box, with friction.
inline World bed(const BedSettings& s) {
    const stress::Tumble tumble{
        .grains = s.grains, .bodies = s.bodies, .seed = s.seed, .walls = s.walls == Walls::planes};
    World world = stress::tumbling(tumble);
    if (s.walls == Walls::facets) add_facet_box(world, Vec3::Zero(), stress::box_of(tumble), 4, 1);
    return world;
}

/// A specimen with frictionless platens: a servo-controlled membrane of `rings` x `sectors`
/// elements about z, closed by two planes.
struct TubeSettings {
    unsigned rings = 2, sectors = 8;
    double radius = 0.05, height = 0.1, pressure = 1e4;
    double contact_stiffness = 1e5; ///< N/m, of the contact between a grain and an element
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

/// Observed order of convergence: log2 of the error ratio when the step is halved.
inline double order_of(double coarse_error, double fine_error) {
    return std::log2(coarse_error / fine_error);
}

} // namespace bris::testing
