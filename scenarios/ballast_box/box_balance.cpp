#include "scenarios/ballast_box/box_balance.hpp"

#include "components/kinds.hpp"
#include "components/load.hpp"
#include "components/settings.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/balance.hpp"

namespace bris {

BoxBalance box_balance(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const double gravity = world.resource<Gravity>().value.z();
    const Balance all = compute_balance(world);
    BoxBalance balance{.unbalanced_ratio = all.unbalanced_ratio, .carries = carries_load(all)};
    const auto& of_box = world.resource<BoxBodies>();
    for (const EntityId tie : of_box.ties) {
        const Row row = row_of_body(world, tie);
        balance.tie_load -= bodies.column<LoadForce>()[row].force.z() +
                            bodies.column<PatchForce>()[row].force.z() +
                            bodies.column<Mass>()[row] * gravity;
        balance.tie_support += contact_force(world, tie).z();
    }
    for (const EntityId plate : of_box.subgrade)
        balance.subgrade_force -= contact_force(world, plate).z();
    return balance;
}

} // namespace bris
