#include "scenarios/specimens/saved_world.hpp"

#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/sleeve.hpp"
#include "engine/errors.hpp"
#include "engine/state.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/fields/coupled_fields.hpp"

#include <cmath>

namespace bris {

namespace {

/// Rings and sectors of a membrane from the number of its elements; its pressure is that of each
/// ring, or of each element, and then it has the twelve sectors of the triaxial specimen.
Membrane membrane_of(const Archive& state) {
    const std::size_t elements = state.get<double>("elements/radius").size(),
                      groups = state.get<double>("membrane/pressure").size();
    Membrane membrane;
    membrane.per_element = groups == elements;
    const std::size_t sectors = membrane.per_element ? 12 : elements / groups;
    membrane.sectors = static_cast<unsigned>(sectors);
    membrane.rings = static_cast<unsigned>(elements / sectors);
    for (std::size_t k = 0; k < sectors; ++k) {
        const double angle = 2 * pi * (static_cast<double>(k) + 0.5) / static_cast<double>(sectors);
        membrane.outward.push_back({std::cos(angle), std::sin(angle), 0});
    }
    return membrane;
}

} // namespace

World world_of_state(const Archive& state) {
    require(state.find("bodies/position") != nullptr && state.find("spheres/ball") != nullptr,
            "checkpoint: expected bodies and spheres, found none");
    World world =
        make_world(state.find("bodies/orientation") != nullptr ? Grains::clumps : Grains::spheres);
    std::size_t materials = 0;
    while (state.find("materials/" + std::to_string(materials)) != nullptr) ++materials;
    world.resource<Materials>().list.resize(materials);
    if (state.find("planes/id") != nullptr) {
        Table& planes = world.table<Planes>();
        planes.add<PlaneId>();
        planes.add<HostId>();
        planes.add<LocalPlane>();
    }
    if (state.find("elements/radius") != nullptr) {
        Table& elements = world.table<Elements>();
        elements.add<ElementId>();
        elements.add<ElementRadius>();
        world.add_resource(membrane_of(state));
    }
    if (state.find("nodes/id") != nullptr) {
        Table& nodes = world.table<Nodes>();
        nodes.add<NodeId>();
        nodes.add<NodePosition>();
        world.add_resource<Membrane>();
        world.add_resource<Sleeve>();
    }
    add_saved_fields(world, state);
    load_state(world, state);
    return world;
}

} // namespace bris
