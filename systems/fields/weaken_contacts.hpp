#pragma once

#include "engine/world.hpp"

#include <vector>

namespace bris {

/// What the contacts were weakened for last, in scenes with fields that act on contacts. Derived.
struct Weakening {
    static constexpr auto name = "weakening";
    std::vector<std::uint64_t> revisions = {}; ///< of the fields of the scene
    std::uint64_t rebuilds = 0;                ///< of the lists
    bool done = false;
};

/// Whether the fields that contacts see have changed since these were weakened, or new candidates
/// were made. False without fields.
bool weakening_is_due(const World& world);

/// Gives the contacts of every pair of bodies that fields weaken coefficients of their own, a row
/// behind those of the pairs of materials. Contacts that no field weakens keep the row of their
/// materials.
void weaken_contacts(World& world, Weakening& weakening);

} // namespace bris
