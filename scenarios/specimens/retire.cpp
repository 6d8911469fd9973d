#include "scenarios/specimens/retire.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/slab.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ranks.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

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

/// What all ranks have found, if each has a part of the world.
std::vector<EntityId> found_by_all(const World& world, const std::vector<EntityId>& here) {
    if (!world.has_resource<Slab>()) return here;
    const auto bytes = std::as_bytes(std::span(here));
    std::vector<EntityId> all;
    for (const Ranks::Bytes& some : Ranks::share({bytes.begin(), bytes.end()})) {
        const std::size_t before = all.size();
        all.resize(before + some.size() / sizeof(EntityId));
        std::ranges::copy(some, std::as_writable_bytes(std::span(all).subspan(before)).begin());
    }
    return all;
}

template <class Pairs>
void rename_pairs(World& world, const ClosedIds& name) {
    if (!world.has<Pairs>()) return;
    Table& pairs = world.table<Pairs>();
    for (PairNames& k : pairs.template column<PairKey>()) {
        k.owner = name(k.owner);
        k.partner = name(k.partner);
    }
    const auto key = pairs.template column<PairKey>();
    keep_rows(pairs, [&](Row r) { return key[r].owner != nobody && key[r].partner != nobody; });
}

ClosedIds names_of_bodies(const World& world, const std::vector<Row>& gone) {
    const auto id = world.column<Bodies, BodyId>();
    std::vector<EntityId> ids;
    for (const Row r : gone) {
        require(world.column<Bodies, MotionOf>()[r] == static_cast<std::uint32_t>(Motion::free),
                fmt::format("body {}: expected a free body to retire, found another kind of motion",
                            id[r]));
        ids.push_back(id[r]);
    }
    return ClosedIds(found_by_all(world, ids));
}

/// Those of bodies that are gone.
ClosedIds names_of_spheres(const World& world, const ClosedIds& of_bodies) {
    const auto id = world.column<Spheres, SphereId>();
    const auto parent = world.column<Spheres, ParentId>();
    std::vector<EntityId> ids;
    for (Row s = 0; s < id.size(); ++s)
        if (of_bodies(parent[s]) == nobody) ids.push_back(id[s]);
    return ClosedIds(found_by_all(world, ids));
}

} // namespace

ClosedIds::ClosedIds(std::vector<EntityId> gone) : gone_(std::move(gone)) {
    std::ranges::sort(gone_);
    gone_.erase(std::ranges::unique(gone_).begin(), gone_.end());
}

EntityId ClosedIds::operator()(EntityId id) const {
    const auto at = std::ranges::lower_bound(gone_, id);
    return at != gone_.end() && *at == id ? nobody : id - static_cast<EntityId>(at - gone_.begin());
}

ClosedIds retire_bodies(World& world, const std::vector<Row>& gone) {
    require(!world.has<Sensors>(),
            "retire bodies: expected a scene without sensors, found one with sensors");
    const ClosedIds name = names_of_bodies(world, gone),
                    sphere_name = names_of_spheres(world, name);
    const auto rename = [](std::span<EntityId> ids, const ClosedIds& names) {
        for (EntityId& id : ids) id = names(id);
    };
    for_each_kind_of_pair([&]<class Pairs>() { rename_pairs<Pairs>(world, name); });
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    rename(spheres.column<SphereId>(), sphere_name);
    rename(spheres.column<ParentId>(), name);
    keep_rows(spheres, [&](Row r) { return spheres.column<SphereId>()[r] != nobody; });
    rename(bodies.column<BodyId>(), name);
    keep_rows(bodies, [&](Row r) { return bodies.column<BodyId>()[r] != nobody; });
    if (world.has<Planes>()) rename(world.column<Planes, HostId>(), name);
    if (world.has<Facets>()) rename(world.column<Facets, HostId>(), name);
    if (world.has_resource<Membrane>())
        world.resource<Membrane>().body = name(world.resource<Membrane>().body);
    if (world.has_resource<Slab>()) world.resource<Slab>().just_taken = false; // ghosts are new
    forget_lists(world);
    return name;
}

} // namespace bris
