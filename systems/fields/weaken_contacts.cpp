#include "systems/fields/weaken_contacts.hpp"

#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"

namespace bris {

namespace {

/// What determines the coefficients of the contacts of two bodies.
struct Scene {
    const Materials& materials;
    const FoulingLaw& law;
    std::span<const std::uint32_t> material;
    std::vector<Row> row; ///< by id
    std::span<const LocalFouling> around;

    WeakenedPair of(EntityId a, EntityId b, bool between_rocks) const {
        LocalFouling at = around[a];
        if (between_rocks)
            at = {0.5 * (at.contaminant + around[b].contaminant),
                  0.5 * (at.saturation + around[b].saturation)};
        return {materials.pair(material[row[a]], material[row[b]]), law.friction_factor(at),
                law.least_friction, law.stiffness_factor(at)};
    }
};

template <class Pairs>
void weaken(World& world, const Scene& scene, std::vector<WeakenedPair>& weakened) {
    if (!world.has<Pairs>()) return;
    const auto names = world.column<Pairs, PairKey>();
    const auto rows = world.column<Pairs, PairRows>();
    PairNames last{nobody, nobody, 0, 0};
    Row law = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) { // the pairs of two bodies are contiguous
        if (names[k].owner != last.owner || names[k].partner != last.partner) {
            last = names[k];
            const WeakenedPair pair =
                scene.of(last.owner, last.partner, std::is_same_v<Pairs, SpherePairs>);
            law = pair.pair;
            if (pair.friction != 1 || pair.stiffness != 1) {
                law = static_cast<Row>(scene.materials.pairs_of_materials() + weakened.size());
                weakened.push_back(pair);
            }
        }
        rows[k].law = law;
    }
    const auto near = world.column<typename Pairs::Near, NearPair>();
    for_rows(near.size(), [&](Row k) { near[k].law = rows[near[k].pair].law; });
}

} // namespace

bool weakening_is_due(const World& world) {
    if (!world.has_resource<Weakening>()) return false;
    const auto& w = world.resource<Weakening>();
    return !w.done || w.revision != world.resource<Fouling>().revision ||
           w.rebuilds != world.resource<ListState>().rebuilds;
}

void weaken_contacts(World& world, const Fouling& fouling, const FoulingLaw& law,
                     Weakening& weakening) {
    if (!weakening_is_due(world)) return;
    auto& materials = world.resource<Materials>();
    std::vector<WeakenedPair> weakened;
    const Scene scene{materials, law, world.column<Bodies, MaterialOf>(),
                      rows_by_id(world.column<Bodies, BodyId>()),
                      world.column<FouledBodies, FoulingAround>()};
    for_each_kind_of_pair([&]<class Pairs>() { weaken<Pairs>(world, scene, weakened); });
    materials.weaken(std::move(weakened));
    weakening = {fouling.revision, world.resource<ListState>().rebuilds, true};
}

} // namespace bris
