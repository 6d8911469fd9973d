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
    std::uint32_t law;
    double radius; ///< m, effective radius
    double share;  ///< share of the stiffness of its contact patch
};

/// All touching pairs of one kind, in the order of their names.
template <class Pairs>
std::vector<TouchingPair> touching_pairs(const World& world) {
    std::vector<TouchingPair> list;
    if (!world.has<Pairs>()) return list;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const Table& pairs = world.table<Pairs>();
    const auto names = pairs.template column<PairKey>();
    const SpringRow* spring =
        pairs.template has<Spring>() ? pairs.template column<Spring>().data() : nullptr;
    const RollRow* roll =
        pairs.template has<Roll>() ? pairs.template column<Roll>().data() : nullptr;
    const Table& near = world.table<typename Pairs::Near>();
    const double* share =
        near.template has<PatchShare>() ? near.template column<PatchShare>().data() : nullptr;
    const auto sphere_row = world.column<Listed, ListedPosition>();
    index.for_touching([&](Row k) {
        const Row p = entry[k].pair;
        list.push_back({names[p], force[k], spring != nullptr ? spring[p] : SpringRow{},
                        roll != nullptr ? roll[p] : RollRow{}, entry[k].law,
                        effective_radius<Pairs>(entry[k], sphere_row),
                        share != nullptr ? share[k] : 1});
    });
    std::sort(list.begin(), list.end(),
              [](const TouchingPair& a, const TouchingPair& b) { return a.names < b.names; });
    return list;
}

} // namespace bris
