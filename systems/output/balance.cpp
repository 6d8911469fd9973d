#include "systems/output/balance.hpp"

#include "components/body.hpp"
#include "components/body_contacts.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/ordering.hpp"
#include "systems/output/outer_force.hpp"

#include <vector>

namespace bris {

namespace {

struct Sum {
    Vec3 resultant = Vec3::Zero();
    double total = 0;
    std::size_t contacts = 0;
};

template <class Pairs>
void add_pairs(const World& world, std::vector<Sum>& sums, Balance& balance) {
    if (!world.has<Pairs>()) return;
    const BodyContacts<Pairs> contacts(world);
    const auto force = world.column<typename Pairs::Near, PairForce>();
    for (Row b = 0; b < sums.size(); ++b)
        contacts.visit(b, [&](Row k, bool as_partner) {
            const Vec3 f(force[k].fx, force[k].fy, force[k].fz);
            sums[b].resultant += as_partner ? -f : f;
            sums[b].total += f.norm();
            ++sums[b].contacts;
            if (!as_partner) ++balance.contacts;
        });
}

} // namespace

Balance compute_balance(const World& world) {
    Balance balance;
    std::vector<Sum> sums(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, sums, balance); });
    const auto motion = world.column<Bodies, MotionOf>();
    const OuterForces outer(world);
    double unbalanced = 0, total = 0;
    for (const Row b : rows_by_id(world.column<Bodies, BodyId>())) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        ++balance.free_bodies;
        if (sums[b].contacts == 0) ++balance.idle_bodies;
        unbalanced += (sums[b].resultant + outer(b)).norm();
        total += sums[b].total + outer.magnitude(b);
    }
    if (total > 0) balance.unbalanced_ratio = unbalanced / total;
    return balance;
}

} // namespace bris
