#include "systems/output/balance.hpp"

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/exact_sum.hpp"
#include "systems/output/outer_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace bris {

namespace {

/// Contact forces on a body in units of the ForceGrid: integers, as in a step, so that their order
/// does not change a bit, and wide ones, because a boundary may have any number of contacts.
struct Sum {
    WideInteger x = 0, y = 0, z = 0, total = 0;
    WideInteger contacts = 0;
    std::array<WideInteger*, 5> numbers() { return {&x, &y, &z, &total, &contacts}; }
    void add(const Vec3& units) {
        const auto integer = [](double u) { return WideInteger{std::llrint(u)}; };
        x += integer(units.x());
        y += integer(units.y());
        z += integer(units.z());
        total += integer(units.norm());
        ++contacts;
    }
    Vec3 resultant() const { return {real(x), real(y), real(z)}; }
    /// Most integers fit into 64 bits, which are converted much faster.
    static double real(WideInteger wide) {
        const auto narrow = static_cast<std::int64_t>(wide);
        return narrow == wide ? static_cast<double>(narrow) : static_cast<double>(wide);
    }
};

template <class Pairs>
void add_pairs(const World& world, const OverRanks& ranks, double per_force, std::vector<Sum>& sums,
               Balance& balance) {
    if (!world.has<Pairs>()) return;
    const auto near = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto body = world.column<Listed, ListedBody>();
    world.resource<NearIndex<Pairs>>().for_touching([&](Row k) {
        const Vec3 units = per_force * Vec3(force[k].fx, force[k].fy, force[k].fz);
        const Row owner = body[near[k].owner];
        sums[owner].add(units);
        sums[rows[near[k].pair].partner_body].add(-units);
        if (ranks.counts(owner)) ++balance.contacts;
    });
}

/// Each rank has found the contacts of its own grains with the boundaries, which all ranks have.
void add_boundaries_over_ranks(const World& world, const OverRanks& ranks, std::vector<Sum>& sums) {
    if (!ranks.is_divided()) return;
    std::vector<Row> boundaries = world.resource<Census>().boundaries;
    const auto id = world.column<Bodies, BodyId>(); // each rank sorts its rows as it likes
    std::ranges::sort(boundaries, {}, [&](Row b) { return id[b]; });
    std::vector<WideInteger> all;
    for (const Row b : boundaries)
        for (const WideInteger* number : sums[b].numbers()) all.push_back(*number);
    add_over_ranks(all);
    const WideInteger* next = all.data();
    for (const Row b : boundaries)
        for (WideInteger* number : sums[b].numbers()) *number = *next++;
}

} // namespace

Balance compute_balance(const World& world) {
    Balance balance;
    const OverRanks ranks(world);
    std::vector<Sum> sums(world.table<Bodies>().size());
    const double unit = world.resource<ForceGrid>().force; // 0 before the first step
    for_each_kind_of_pair([&]<class Pairs>() {
        add_pairs<Pairs>(world, ranks, unit > 0 ? 1 / unit : 0, sums, balance);
    });
    add_boundaries_over_ranks(world, ranks, sums);
    const auto motion = world.column<Bodies, MotionOf>();
    const OuterForces outer(world);
    ExactSum unbalanced, total;
    for (Row b = 0; b < sums.size(); ++b) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free) || !ranks.counts(b)) continue;
        ++balance.free_bodies;
        if (sums[b].contacts == 0) ++balance.idle_bodies;
        unbalanced.add((unit * sums[b].resultant() + outer(b)).norm());
        total.add(unit * Sum::real(sums[b].total) + outer.magnitude(b));
    }
    ranks.add({&unbalanced, &total});
    ranks.add({&balance.contacts, &balance.free_bodies, &balance.idle_bodies});
    if (total.value() > 0) balance.unbalanced_ratio = unbalanced.value() / total.value();
    return balance;
}

} // namespace bris
