#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// The ids of things of which some were removed, closed up: from 0 without gaps, in the order of
/// the old ones.
class ClosedIds {
public:
    /// `gone`: the removed ids, in any order; those of several ranks may repeat each other.
    explicit ClosedIds(std::vector<EntityId> gone);
    /// The new id; `nobody` for those that were removed.
    EntityId operator()(EntityId id) const;
    std::size_t removed() const { return gone_.size(); }

private:
    std::vector<EntityId> gone_; ///< ascending
};

/// Removes free bodies from a scene between two steps, with their spheres and contacts, so that
/// they cost no more time. The other bodies are renumbered without gaps in the order of their ids,
/// which keeps the order of all sums. Returns the new ids of bodies, by which those that are stored
/// elsewhere must be updated. `gone`: rows of Bodies in any order; of a world that is divided among
/// ranks, which all call this, the rows in this part, ghosts included. The pair lists are rebuilt
/// before the next step and keep the contact springs; until then contacts are unknown. Throws
/// InputError if the scene has sensors or a body is not free.
ClosedIds retire_bodies(World& world, const std::vector<Row>& gone);

} // namespace bris
