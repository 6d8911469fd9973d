#include "systems/output/balance.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "engine/ordering.hpp"

#include <vector>

namespace bris {

namespace {

struct Sum {
    Vec3 resultant = Vec3::Zero();
    double total = 0;
    std::size_t contacts = 0;
};

template <class Pairs> void add_pairs(const World& world, std::vector<Sum>& sums, Balance& balance) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    if (index.size() == 0) return;
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto add = [&](Sum& sum, Row k, double sign) {
        if (!index.touches(k)) return;
        const Vec3 f(force[k].fx, force[k].fy, force[k].fz);
        sum.resultant += sign * f;
        sum.total += f.norm();
        ++sum.contacts;
    };
    for (Row b = 0; b < sums.size(); ++b) {
        for (Row i = index.incident_first[b]; i < index.incident_first[b + 1]; ++i)
            add(sums[b], index.incident[i], -1);
        for (Row k = index.owned_first[b]; k < index.owned_first[b + 1]; ++k) add(sums[b], k, 1);
    }
    for (Row k = 0; k < index.size(); ++k) 
        if (index.touches(k)) ++balance.contacts;
}

} // namespace

Balance measure_balance(const World& world) {
    Balance balance;
    std::vector<Sum> sums(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, sums, balance); });
    const auto motion = world.column<Bodies, MotionOf>();
    const auto mass = world.column<Bodies, Mass>();
    const Vec3 gravity = world.has_resource<Gravity>() ? world.resource<Gravity>().value : Vec3(Vec3::Zero());
    double unbalanced = 0, total = 0;
    for (const Row b : rows_by_id(world.column<Bodies, BodyId>())) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        ++balance.free_bodies;
        if (sums[b].contacts == 0) ++balance.idle_bodies;
        const Vec3 weight = mass[b] * gravity;
        unbalanced += (sums[b].resultant + weight).norm();
        total += sums[b].total + weight.norm();
    }
    if (total > 0) balance.unbalanced_ratio = unbalanced / total;
    return balance;
}

} // namespace bris
