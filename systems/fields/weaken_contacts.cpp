#include "systems/fields/weaken_contacts.hpp"

#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"
#include "systems/fields/coupled_fields.hpp"

#include <optional>
#include <tuple>

namespace bris {

namespace {

/// What determines the coefficients of the contacts of two bodies.
class Coefficients {
public:
    explicit Coefficients(const World& world)
        : materials_(world.resource<Materials>()), material_(world.column<Bodies, MaterialOf>()),
          row_of_(world.column<Bodies, BodyId>()) {
        for_each_field_of(world, [&]<class F>() {
            std::get<std::optional<typename F::Factors>>(fields_).emplace(world);
        });
    }
    std::size_t pairs_of_materials() const { return materials_.pairs_of_materials(); }
    WeakenedPair of(EntityId owner, EntityId partner, bool between_rocks) const {
        const Row a = row_of_[owner], b = row_of_[partner];
        ContactFactors all;
        for_each_field([&]<class F>() {
            if (const auto& field = std::get<std::optional<typename F::Factors>>(fields_))
                all.multiply(field->of(a, b, between_rocks));
        });
        return {materials_.pair(material_[a], material_[b]), all.friction, all.least_friction,
                all.stiffness};
    }

private:
    template <class... Fs>
    static std::tuple<std::optional<typename Fs::Factors>...> factors_of(FieldList<Fs...>);

    const Materials& materials_;
    std::span<const std::uint32_t> material_;
    RowIndex row_of_;
    decltype(factors_of(CoupledFields{})) fields_;
};

template <class Pairs>
void weaken(World& world, const Coefficients& coefficients, std::vector<WeakenedPair>& weakened) {
    if (!world.has<Pairs>()) return;
    const auto names = world.column<Pairs, PairKey>();
    const auto rows = world.column<Pairs, PairRows>();
    PairNames last{nobody, nobody, 0, 0};
    Row law = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) { // the pairs of two bodies are contiguous
        if (names[k].owner != last.owner || names[k].partner != last.partner) {
            last = names[k];
            const WeakenedPair pair =
                coefficients.of(last.owner, last.partner, std::is_same_v<Pairs, SpherePairs>);
            law = pair.pair;
            if (pair.friction != 1 || pair.stiffness != 1) {
                law = static_cast<Row>(coefficients.pairs_of_materials() + weakened.size());
                weakened.push_back(pair);
            }
        }
        rows[k].law = law;
    }
    const auto near = world.column<typename Pairs::Near, NearPair>();
    for_rows(near.size(), [&](Row k) { near[k].law = rows[near[k].pair].law; });
}

std::vector<std::uint64_t> revisions_of(const World& world) {
    std::vector<std::uint64_t> revisions;
    for_each_field_of(world, [&]<class F>() {
        revisions.push_back(world.resource<typename F::Field>().revision);
    });
    return revisions;
}

} // namespace

bool weakening_is_due(const World& world) {
    if (!world.has_resource<Weakening>()) return false;
    const auto& w = world.resource<Weakening>();
    return !w.done || w.revisions != revisions_of(world) ||
           w.rebuilds != world.resource<ListState>().rebuilds;
}

void weaken_contacts(World& world, Weakening& weakening) {
    if (!weakening_is_due(world)) return;
    std::vector<WeakenedPair> weakened;
    const Coefficients coefficients(world);
    for_each_kind_of_pair([&]<class Pairs>() { weaken<Pairs>(world, coefficients, weakened); });
    world.resource<Materials>().weaken(std::move(weakened));
    weakening = {revisions_of(world), world.resource<ListState>().rebuilds, true};
}

} // namespace bris
