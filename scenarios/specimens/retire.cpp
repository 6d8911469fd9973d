#include "scenarios/specimens/retire.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// Keeps the rows of a table for which `stays` is true, in their order.
template <class Stays>
void keep_rows(Table& table, Stays&& stays) {
    std::vector<Row> kept;
    for (Row r = 0; r < table.size(); ++r)
        if (stays(r)) kept.push_back(r);
    if (kept.size() < table.size()) table.keep(kept);
}

/// New ids from 0 without gaps, in the order of the old ones, for the ids that stay.
template <class Stays>
std::vector<EntityId> close_up(std::size_t ids, Stays&& stays) {
    std::vector<EntityId> name(ids, nobody);
    EntityId next = 0;
    for (EntityId id = 0; id < ids; ++id)
        if (stays(id)) name[id] = next++;
    return name;
}

template <class Pairs>
void rename_pairs(World& world, const std::vector<EntityId>& name) {
    if (!world.has<Pairs>()) return;
    Table& pairs = world.table<Pairs>();
    const auto key = pairs.template column<PairKey>();
    keep_rows(pairs, [&](Row r) {
        return name[key[r].owner] != nobody && name[key[r].partner] != nobody;
    });
    for (PairNames& k : pairs.template column<PairKey>()) {
        k.owner = name[k.owner];
        k.partner = name[k.partner];
    }
}

} // namespace

std::vector<EntityId> retire_bodies(World& world, const std::vector<Row>& gone) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    require(!world.has<Sensors>(),
            "retire bodies: expected a scene without sensors, found one with sensors");
    std::vector<char> stays(bodies.size(), 1);
    for (const Row r : gone) {
        require(bodies.column<MotionOf>()[r] == static_cast<std::uint32_t>(Motion::free),
                fmt::format("body {}: expected a free body to retire, found another kind of motion",
                            bodies.column<BodyId>()[r]));
        stays[r] = 0;
    }
    const auto row_of = rows_by_id(bodies.column<BodyId>());
    const auto name = close_up(row_of.size(), [&](EntityId id) { return stays[row_of[id]] != 0; });

    for_each_kind_of_pair([&]<class Pairs>() { rename_pairs<Pairs>(world, name); });
    const auto sphere_row = rows_by_id(spheres.column<SphereId>());
    const auto parent = spheres.column<ParentId>();
    const auto sphere_name = close_up(
        sphere_row.size(), [&](EntityId id) { return name[parent[sphere_row[id]]] != nobody; });
    for (EntityId& id : spheres.column<SphereId>()) id = sphere_name[id];
    for (EntityId& id : spheres.column<ParentId>()) id = name[id];
    keep_rows(spheres, [&](Row r) { return spheres.column<SphereId>()[r] != nobody; });
    for (EntityId& id : bodies.column<BodyId>()) id = name[id];
    keep_rows(bodies, [&](Row r) { return bodies.column<BodyId>()[r] != nobody; });
    if (world.has<Planes>())
        for (EntityId& id : world.column<Planes, HostId>()) id = name[id];
    if (world.has<Facets>())
        for (EntityId& id : world.column<Facets, HostId>()) id = name[id];
    if (world.has_resource<Membrane>())
        world.resource<Membrane>().body = name[world.resource<Membrane>().body];
    forget_lists(world);
    return name;
}

} // namespace bris
