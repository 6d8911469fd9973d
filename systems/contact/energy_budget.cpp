#include "systems/contact/energy_budget.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"

namespace bris {

void add_energy_budget(World& world) {
    Table& bodies = world.table<Bodies>();
    bodies.add<FrictionWork>();
    bodies.add<ViscousWork>();
    bodies.add<RollingWork>();
    bodies.add<DampingWork>();
    bodies.add<ScalingWork>();
    bodies.add<BoundaryWork>();
    for_each_kind_of_pair([&]<class Pairs>() {
        if (world.has<Pairs>() && world.table<Pairs>().template has<Spring>())
            world.table<typename Pairs::Near>().template add<PairWork>();
    });
    // a membrane has no friction, but it may have dashpots
    if (world.has<MembranePairs>() && has_dashpots(world.resource<ContactLaw>().law))
        world.table<NearMembrane>().add<PairWork>();
}

} // namespace bris
