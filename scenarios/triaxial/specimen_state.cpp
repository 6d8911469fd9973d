#include "scenarios/triaxial/specimen_state.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/ordering.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sleeve.hpp"
#include "systems/servo/membrane.hpp"

#include <algorithm>

namespace bris {

double membrane_radius(const World& world) {
    return world.has<Nodes>() ? world.resource<Sleeve>().radius
                              : world.column<Elements, ElementRadius>().front();
}

double platen_height(const World& world) {
    return world.column<Bodies, Position>()[row_of_body(world, world.resource<Specimen>().top)].z();
}

double specimen_volume(const World& world) {
    if (world.has<Nodes>()) return sleeve_volume(world);
    return membrane_volume(world.resource<Membrane>(),
                           world.column<Elements, ElementRadius>().data(), platen_height(world));
}

SpecimenLoad specimen_load(const World& world) {
    const auto& specimen = world.resource<Specimen>();
    const auto force = world.column<Bodies, Force>();
    const double top = platen_height(world), volume = specimen_volume(world),
                 on_top = force[row_of_body(world, specimen.top)].z(),
                 on_bottom = force[row_of_body(world, specimen.bottom)].z(),
                 axial = 0.5 * (on_top - on_bottom) * top / volume;
    if (world.has<Nodes>())
        return {top, volume, axial - world.resource<Platen>().pull * top / volume,
                world.resource<Sleeve>().pressure};
    const Table& elements = world.table<Elements>();
    double area = 0, push = 0;
    for (std::size_t e = 0; e < elements.size(); ++e) {
        push += elements.column<ElementPush>()[e];
        area += elements.column<ElementArea>()[e];
    }
    return {top, volume, axial, push / area};
}

std::vector<double> ring_radii(const World& world) {
    const auto& membrane = world.resource<Membrane>();
    if (world.has<Nodes>()) return sleeve_radii(world, membrane.rings);
    std::vector<double> mean(membrane.rings, 0);
    const auto radius = world.column<Elements, ElementRadius>();
    for (std::size_t e = 0; e < radius.size(); ++e)
        mean[e / membrane.sectors] += radius[e] / membrane.sectors;
    return mean;
}

CylinderRegion core(const World& world) {
    const double wall = membrane_radius(world), top = platen_height(world);
    return {0.6 * wall, 0.25 * top, 0.75 * top};
}

double mean_size(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto mass = bodies.column<Mass>();
    const auto& materials = world.resource<Materials>();
    const auto material = bodies.column<MaterialOf>();
    double all = 0, size = 0;
    for (const Row r : in_order_of_ids(bodies.column<BodyId>())) {
        if (!(mass[r] > 0)) continue;
        all += mass[r];
        size += mass[r] * std::cbrt(6 * mass[r] / (pi * materials.list[material[r]].density));
    }
    return size / all;
}

void set_friction(World& world, double friction) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    materials.list[specimen.sensor_material].friction =
        specimen.sensor_friction < 0 ? friction : specimen.sensor_friction;
    materials.list[specimen.rock_material].friction = friction;
    materials.list[specimen.platen_material].friction =
        specimen.platen_friction < 0 ? friction : specimen.platen_friction;
    materials.mix();
}

void set_rocks(World& world, double friction, double stiffness) {
    const auto& specimen = world.resource<Specimen>();
    for (const std::uint32_t material : {specimen.rock_material, specimen.sensor_material}) {
        Material& rock = world.resource<Materials>().list[material];
        rock.young_modulus *= stiffness / rock.normal_stiffness; // 0 where contacts are linear
        rock.normal_stiffness = rock.shear_stiffness = stiffness;
    }
    set_friction(world, friction);
    world.resource<Membrane>().contact_stiffness = world.resource<Platen>().contact_stiffness =
        wall_contact_stiffness(world);
}

double wall_contact_stiffness(const World& world) {
    const auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    return materials
        .linear_pairs[materials.pair(specimen.rock_material, specimen.membrane_material)]
        .kn;
}

std::vector<SensorDrift> sensor_drift(const World& world) {
    const auto& specimen = world.resource<Specimen>();
    const Vec3 scale(1, 1, platen_height(world) / specimen.height);
    std::vector<SensorDrift> all;
    for (std::size_t i = 0; i < specimen.smart_rocks.size(); ++i) {
        const Row r = row_of_body(world, specimen.smart_rocks[i]);
        all.push_back({specimen.smart_rocks[i],
                       specimen.smart_rock_poses[i].position.cwiseProduct(scale),
                       world.column<Bodies, Position>()[r],
                       world.column<Bodies, Orientation>()[r].angularDistance(
                           specimen.smart_rock_poses[i].orientation)});
    }
    return all;
}

void stop_rocks(World& world) {
    const auto stop = [&]<class Column>() {
        for (auto& value : world.column<Bodies, Column>()) value.setZero();
    };
    stop.template operator()<Velocity>();
    stop.template operator()<AngularMomentum>();
    stop.template operator()<AngularVelocity>();
    stop.template operator()<StepAngularVelocity>();
}

namespace {

/// The part of a displacement (m) that leaves the spheres of a held body in the mould. There are no
/// contacts between the mould and a held body.
Vec3 within_mould(const World& world, Row body, Vec3 way) {
    const double wall = membrane_radius(world), top = platen_height(world);
    const Vec3 position = world.column<Bodies, Position>()[body];
    const Quat orientation = world.column<Bodies, Orientation>()[body];
    const SphereRun run = world.column<Bodies, SpheresOf>()[body];
    const auto ball = world.column<Spheres, LocalBall>();
    for (Row k = run.first; k < run.first + run.count; ++k) {
        const Vec3 centre = position + orientation * ball[k].centre;
        const double radius = ball[k].radius;
        for (const Vec3& outward : world.resource<Membrane>().outward)
            way -= std::max(0.0, (centre + way).dot(outward) + radius - wall) * outward;
        way.z() += std::max(0.0, radius - centre.z() - way.z());
        way.z() -= std::max(0.0, centre.z() + way.z() + radius - top);
    }
    return way;
}

} // namespace

void lead_sensor_rocks(World& world, std::uint64_t steps, bool halve_reversals) {
    constexpr double most_force = 10; // contact force over pressure times cross-section
    constexpr double shrink = 0.5, grow = 1.2, least_step = 0.01;
    const auto& platen = world.resource<Platen>();
    const auto& specimen = world.resource<Specimen>();
    const auto& materials = world.resource<Materials>();
    const double stiffness =
        materials.linear_pairs[materials.pair(specimen.rock_material, specimen.sensor_material)].kn;
    const double time = static_cast<double>(steps) * world.resource<Clock>().dt;
    const double farthest = 2 * static_cast<double>(steps) * platen.largest_step;
    for (const SensorDrift& d : sensor_drift(world)) {
        const Row r = row_of_body(world, d.body);
        const double radius = world.column<Bodies, BoundingRadius>()[r];
        const Vec3 force = world.column<Bodies, Force>()[r];
        const double limit = most_force * platen.target_pressure * pi * radius * radius,
                     share = force.norm() / limit; // 0 without a limit
        Vec3 way = std::max(0.0, 1 - share) * (d.given - d.now);
        if (share > 1) way += 0.5 * (1 - 1 / share) / stiffness * force;
        way = within_mould(world, r, way);
        Vec3& velocity = world.column<Bodies, DriveVelocity>()[r];
        const double last = time * velocity.norm();
        const double longest = halve_reversals
                                   ? std::clamp((way.dot(velocity) < 0 ? shrink : grow) * last,
                                                least_step * farthest, farthest)
                                   : farthest;
        way *= std::min(1.0, longest / std::max(way.norm(), 1e-300));
        velocity = way / time;
    }
}

} // namespace bris
