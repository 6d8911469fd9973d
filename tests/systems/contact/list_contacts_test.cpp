#include "components/pair.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

/// Touching pairs of a body, found from the flags of all near rows: those in which it is the
/// partner, by ascending owner, then those that it owns.
template <class Pairs>
std::vector<std::pair<Row, bool>> contacts_by_search(const World& world, Row body) {
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto names = world.column<Pairs, PairKey>();
    const EntityId id = world.column<Bodies, BodyId>()[body];
    std::vector<std::pair<Row, bool>> found;
    for (Row k = 0; k < index.size(); ++k)
        if (index.touches(k) && names[entry[k].pair].partner == id) found.emplace_back(k, true);
    std::stable_sort(found.begin(), found.end(), [&](const auto& a, const auto& b) {
        return names[entry[a.first].pair].owner < names[entry[b.first].pair].owner;
    });
    for (Row k = 0; k < index.size(); ++k)
        if (index.touches(k) && names[entry[k].pair].owner == id) found.emplace_back(k, false);
    return found;
}

template <class Pairs>
std::size_t check_all(const World& world) {
    const auto& index = world.resource<NearIndex<Pairs>>();
    std::size_t all = 0;
    for (Row b = 0; b < world.table<Bodies>().size(); ++b) {
        std::vector<std::pair<Row, bool>> listed;
        index.for_contacts_of(b,
                              [&](Row k, bool as_partner) { listed.emplace_back(k, as_partner); });
        REQUIRE(listed == contacts_by_search<Pairs>(world, b));
        all += listed.size();
    }
    return all;
}

} // namespace

TEST_SUITE("contact/list_contacts") {
    TEST_CASE(
        "the list of touching pairs of every body is complete and in order while grains settle") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            Simulation sim =
                begin(bed({.grains = grains, .walls = Walls::facets, .bodies = 40, .seed = 3}),
                      {.dt = 2e-5, .law = LawName::linear_viscous});
            std::size_t most = 0;
            for (int k = 0; k < 300; ++k) {
                sim.advance(10);
                most = std::max(most, check_all<SpherePairs>(sim.world()) +
                                          check_all<FacetPairs>(sim.world()));
            }
            CHECK(most > 40); // grains have touched
        }
    }
}
