#include "systems/contact/energy_budget.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "engine/ordering.hpp"
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
    const auto rows = rows_by_id(bodies.column<BodyId>());
    const double springs = sum_by_id(rows, bodies.column<FrictionWork>()) +
                           sum_by_id(rows, bodies.column<ViscousWork>()) +
                           sum_by_id(rows, bodies.column<RollingWork>());
    return bodies.has<WearWork>() ? springs + sum_by_id(rows, bodies.column<WearWork>()) : springs;
}

} // namespace bris
