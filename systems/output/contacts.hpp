#pragma once

#include "components/elasticity.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/world.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace bris {

/// A touching pair: its names, its force on the owner, its springs and its coefficients.
struct TouchingPair {
    PairNames names;
    Row owner, partner; ///< of Bodies
    ForceRow force;
    SpringRow spring;
    RollRow roll;
    double worn; ///< m, radius of its edge, or Worn::never
    std::uint32_t law;
    double radius; ///< m, effective radius
    double share;  ///< share of the stiffness of its contact patch
};

/// The touching pairs of one kind in a world that has some.
template <class Pairs>
class TouchingPairs {
public:
    explicit TouchingPairs(const World& world)
        : index_(world.resource<NearIndex<Pairs>>()),
          entry_(world.column<typename Pairs::Near, NearPair>()),
          force_(world.column<typename Pairs::Near, PairForce>()),
          names_(world.column<Pairs, PairKey>()), rows_(world.column<Pairs, PairRows>()),
          sphere_row_(world.column<Listed, ListedPosition>()),
          body_(world.column<Listed, ListedBody>()), spring_(values_of<Pairs, Spring>(world)),
          roll_(values_of<Pairs, Roll>(world)), worn_(values_of<Pairs, Worn>(world)),
          share_(values_of<typename Pairs::Near, PatchShare>(world)) {}

    /// Calls visit(const TouchingPair&) in the order of the rows: for what has no order, as exact
    /// sums.
    template <class Visit>
    void visit(Visit&& visit) const {
        index_.for_touching([&](Row k) { visit((*this)[k]); });
    }
    /// The same in the order of the names. Takes 4 bytes of memory for each of the pairs.
    template <class Visit>
    void visit_by_name(Visit&& visit) const {
        std::vector<Row> touching; // near rows
        index_.for_touching([&](Row k) { touching.push_back(k); });
        std::ranges::sort(touching, [&](Row a, Row b) {
            return names_[entry_[a].pair] < names_[entry_[b].pair];
        });
        for (const Row k : touching) visit((*this)[k]);
    }

private:
    template <class Kind, class Component>
    static const typename Component::Value* values_of(const World& world) {
        const Table& table = world.table<Kind>();
        return table.template has<Component>() ? table.template column<Component>().data()
                                               : nullptr;
    }
    TouchingPair operator[](Row k) const {
        const Row p = entry_[k].pair;
        return {.names = names_[p],
                .owner = body_[entry_[k].owner],
                .partner = rows_[p].partner_body,
                .force = force_[k],
                .spring = spring_ != nullptr ? spring_[p] : SpringRow{},
                .roll = roll_ != nullptr ? roll_[p] : RollRow{},
                .worn = worn_ != nullptr ? worn_[p] : Worn::never,
                .law = entry_[k].law,
                .radius = effective_radius<Pairs>(entry_[k], sphere_row_),
                .share = share_ != nullptr ? share_[k] : 1};
    }

    const NearIndex<Pairs>& index_;
    std::span<const NearEntry> entry_;
    std::span<const ForceRow> force_;
    std::span<const PairNames> names_;
    std::span<const PairRowNumbers> rows_;
    std::span<const SphereRow> sphere_row_;
    std::span<const Row> body_;
    const SpringRow* spring_; ///< null: the scene has none, as below
    const RollRow* roll_;
    const double *worn_, *share_;
};

/// Calls visit(const TouchingPair&) for all touching pairs of one kind, in the order of their
/// names.
template <class Pairs, class Visit>
void for_touching_pairs(const World& world, Visit&& visit) {
    if (world.has<Pairs>()) TouchingPairs<Pairs>(world).visit_by_name(visit);
}

/// The same as a list, for scenes of few contacts.
template <class Pairs>
std::vector<TouchingPair> touching_pairs(const World& world) {
    std::vector<TouchingPair> list;
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& pair) { list.push_back(pair); });
    return list;
}

} // namespace bris
