#include "systems/output/balance.hpp"

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "systems/output/outer_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace bris {

namespace {

/// Contact forces on a body in units of the ForceGrid: integers, as in a step, so that their order
/// does not change a bit. Those of a grain fit into 64 bits, as the guard of a step sees to it; a
/// boundary may have any number of contacts.
template <class Integer>
struct SumOf {
    Integer x = 0, y = 0, z = 0, total = 0, contacts = 0;
    std::array<Integer*, 5> numbers() { return {&x, &y, &z, &total, &contacts}; }
    void add(const Vec3& units, double size) {
        x += std::llrint(units.x());
        y += std::llrint(units.y());
        z += std::llrint(units.z());
        total += std::llrint(size);
        ++contacts;
    }
    Vec3 resultant() const { return {real(x), real(y), real(z)}; }
    /// Most integers fit into 64 bits, which are converted much faster.
    static double real(Integer wide) {
        const auto narrow = static_cast<std::int64_t>(wide);
        return narrow == wide ? static_cast<double>(narrow) : static_cast<double>(wide);
    }
};

/// The sums of all bodies.
struct Sums {
    std::vector<SumOf<std::int64_t>> grains;    ///< by row
    std::vector<SumOf<WideInteger>> boundaries; ///< in the order of Census::boundaries
    explicit Sums(const World& world)
        : grains(world.table<Bodies>().size()),
          boundaries(world.resource<Census>().boundaries.size()) {}
};

template <class Pairs>
void add_pairs(const World& world, const OverRanks& ranks, double per_force, Sums& sums,
               Balance& balance) {
    if (!world.has<Pairs>()) return;
    const auto near = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto body = world.column<Listed, ListedBody>();
    const auto& boundaries = world.resource<Census>().boundaries; // ascending
    world.resource<NearIndex<Pairs>>().for_touching([&](Row k) {
        const Vec3 units = per_force * Vec3(force[k].fx, force[k].fy, force[k].fz);
        const double size = units.norm();
        const Row owner = body[near[k].owner], partner = rows[near[k].pair].partner_body;
        sums.grains[owner].add(units, size);
        if constexpr (std::is_same_v<Pairs, SpherePairs>) {
            sums.grains[partner].add(-units, size);
        } else {
            const auto at = std::ranges::lower_bound(boundaries, partner) - boundaries.begin();
            sums.boundaries[static_cast<std::size_t>(at)].add(-units, size);
        }
        if (ranks.counts(owner)) ++balance.contacts;
    });
}

/// Each rank has found the contacts of its own grains with the boundaries, which all ranks have.
void add_boundaries_over_ranks(const World& world, const OverRanks& ranks, Sums& sums) {
    if (!ranks.is_divided()) return;
    const auto& rows = world.resource<Census>().boundaries;
    const auto id = world.column<Bodies, BodyId>(); // each rank sorts its rows as it likes
    std::vector<Row> by_id = all_rows(rows.size());
    std::ranges::sort(by_id, {}, [&](Row k) { return id[rows[k]]; });
    std::vector<WideInteger> all;
    for (const Row k : by_id)
        for (const WideInteger* number : sums.boundaries[k].numbers()) all.push_back(*number);
    add_over_ranks(all);
    const WideInteger* next = all.data();
    for (const Row k : by_id)
        for (WideInteger* number : sums.boundaries[k].numbers()) *number = *next++;
}

} // namespace

Balance compute_balance(const World& world) {
    Balance balance;
    const OverRanks ranks(world);
    Sums sums(world);
    const double unit = world.resource<ForceGrid>().force; // 0 before the first step
    for_each_kind_of_pair([&]<class Pairs>() {
        add_pairs<Pairs>(world, ranks, unit > 0 ? 1 / unit : 0, sums, balance);
    });
    add_boundaries_over_ranks(world, ranks, sums);
    const auto motion = world.column<Bodies, MotionOf>();
    const OuterForces outer(world);
    ExactSum unbalanced, total;
    const auto add = [&](Row b, const auto& sum) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free) || !ranks.counts(b)) return;
        ++balance.free_bodies;
        if (sum.contacts == 0) ++balance.idle_bodies;
        unbalanced.add((unit * sum.resultant() + outer(b)).norm());
        total.add(unit * sum.real(sum.total) + outer.magnitude(b));
    };
    const auto& boundaries = world.resource<Census>().boundaries;
    std::size_t boundary = 0;
    for (Row b = 0; b < sums.grains.size(); ++b)
        if (boundary < boundaries.size() && boundaries[boundary] == b)
            add(b, sums.boundaries[boundary++]);
        else
            add(b, sums.grains[b]);
    ranks.add({&unbalanced, &total});
    ranks.add({&balance.contacts, &balance.free_bodies, &balance.idle_bodies});
    if (total.value() > 0) balance.unbalanced_ratio = unbalanced.value() / total.value();
    return balance;
}

} // namespace bris
