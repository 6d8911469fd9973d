#include "scenarios/triaxial/specimen_state.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/servo/membrane.hpp"

namespace bris {

double membrane_radius(const World& world) {
    return world.column<Elements, ElementRadius>().front();
}

double platen_height(const World& world) {
    return world.column<Bodies, Position>()[row_of_body(world, world.resource<Specimen>().top)].z();
}

double specimen_volume(const World& world) {
    return membrane_volume(world.resource<Membrane>(),
                           world.column<Elements, ElementRadius>().data(), platen_height(world));
}

CylinderRegion core(const World& world) {
    const double wall = membrane_radius(world), top = platen_height(world);
    return {0.6 * wall, 0.25 * top, 0.75 * top};
}

void set_friction(World& world, double friction) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    materials.list[specimen.sensor_material].friction =
        specimen.sensor_friction < 0 ? friction : specimen.sensor_friction;
    materials.list[specimen.rock_material].friction = friction;
    materials.list[specimen.platen_material].friction = friction;
    materials.mix();
}

void set_rocks(World& world, double friction, double stiffness) {
    const auto& specimen = world.resource<Specimen>();
    for (const std::uint32_t material : {specimen.rock_material, specimen.sensor_material}) {
        Material& rock = world.resource<Materials>().list[material];
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

} // namespace bris
