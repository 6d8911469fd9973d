#include "systems/contact/energy_budget.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "systems/loads/table.hpp"

namespace bris {

void add_energy_budget(World& world) {
    Table& bodies = world.table<Bodies>();
    bodies.add<FrictionWork>();
    bodies.add<ViscousWork>();
    bodies.add<RollingWork>();
    bodies.add<DampingWork>();
    bodies.add<ScalingWork>();
    bodies.add<BoundaryWork>();
    add_work_of_elements(world);
}

} // namespace bris
