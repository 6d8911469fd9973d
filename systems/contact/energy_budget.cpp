#include "systems/contact/energy_budget.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "engine/exact_sum.hpp"
#include "systems/loads/table.hpp"

namespace bris {

void add_energy_budget(World& world) {
    Table& bodies = world.table<Bodies>();
    bodies.add<FrictionWork>();
    bodies.add<ViscousWork>();
    bodies.add<RollingWork>();
    if (has_wear(world.resource<ContactLaw>().law)) bodies.add<WearWork>();
    bodies.add<DampingWork>();
    bodies.add<ScalingWork>();
    bodies.add<BoundaryWork>();
    add_work_of_elements(world);
}

double dissipated_in_contacts(const World& world) {
    const Table& bodies = world.table<Bodies>();
    if (!bodies.has<FrictionWork>()) return 0;
    const double springs = exact_sum(bodies.column<FrictionWork>()) +
                           exact_sum(bodies.column<ViscousWork>()) +
                           exact_sum(bodies.column<RollingWork>());
    return bodies.has<WearWork>() ? springs + exact_sum(bodies.column<WearWork>()) : springs;
}

} // namespace bris
