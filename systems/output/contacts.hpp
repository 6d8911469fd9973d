#pragma once

#include "components/elasticity.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/world.hpp"

#include <algorithm>
#include <vector>

namespace bris {

/// A touching pair: its names, its force on the owner, its springs and its coefficients.
struct TouchingPair {
    PairNames names;
    ForceRow force;
    SpringRow spring;
    RollRow roll;
    double worn; ///< m, radius of its edge, or Worn::never
    std::uint32_t law;
    double radius; ///< m, effective radius
    double share;  ///< share of the stiffness of its contact patch
};

/// Calls visit(const TouchingPair&) for all touching pairs of one kind, in the order of their
/// names. Takes 4 bytes of memory for each of them.
template <class Pairs, class Visit>
void for_touching_pairs(const World& world, Visit&& visit) {
    if (!world.has<Pairs>()) return;
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const Table& pairs = world.table<Pairs>();
    const auto names = pairs.template column<PairKey>();
    const SpringRow* spring =
        pairs.template has<Spring>() ? pairs.template column<Spring>().data() : nullptr;
    const RollRow* roll =
        pairs.template has<Roll>() ? pairs.template column<Roll>().data() : nullptr;
    const double* worn =
        pairs.template has<Worn>() ? pairs.template column<Worn>().data() : nullptr;
    const Table& near = world.table<typename Pairs::Near>();
    const double* share =
        near.template has<PatchShare>() ? near.template column<PatchShare>().data() : nullptr;
    const auto sphere_row = world.column<Listed, ListedPosition>();
    std::vector<Row> touching; // near rows
    world.resource<NearIndex<Pairs>>().for_touching([&](Row k) { touching.push_back(k); });
    std::ranges::sort(touching,
                      [&](Row a, Row b) { return names[entry[a].pair] < names[entry[b].pair]; });
    for (const Row k : touching) {
        const Row p = entry[k].pair;
        visit(TouchingPair{names[p], force[k], spring != nullptr ? spring[p] : SpringRow{},
                           roll != nullptr ? roll[p] : RollRow{},
                           worn != nullptr ? worn[p] : Worn::never, entry[k].law,
                           effective_radius<Pairs>(entry[k], sphere_row),
                           share != nullptr ? share[k] : 1});
    }
}

/// The same as a list, for scenes of few contacts.
template <class Pairs>
std::vector<TouchingPair> touching_pairs(const World& world) {
    std::vector<TouchingPair> list;
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& pair) { list.push_back(pair); });
    return list;
}

} // namespace bris
