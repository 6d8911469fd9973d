#include "scenarios/ballast_box/box_balance.hpp"

#include "components/kinds.hpp"
#include "components/load.hpp"
#include "components/settings.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/balance.hpp"

namespace bris {

BoxBalance box_balance(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const double gravity = world.resource<Gravity>().value.z();
    const auto outer = [&](Row row) { // vertical force besides patches and contacts
        return bodies.column<LoadForce>()[row].force.z() + bodies.column<Mass>()[row] * gravity;
    };
    const auto from_contacts = [&](Row row) {
        return bodies.column<Force>()[row].z() - bodies.column<PatchForce>()[row].force.z() -
               outer(row);
    };
    const Balance all = compute_balance(world);
    BoxBalance balance{.unbalanced_ratio = all.unbalanced_ratio, .carries = carries_load(all)};
    const auto& of_box = world.resource<BoxBodies>();
    for (const EntityId tie : of_box.ties) {
        const Row row = row_of_body(world, tie);
        balance.tie_load -= outer(row);
        balance.tie_support += from_contacts(row);
    }
    for (const EntityId plate : of_box.subgrade)
        balance.subgrade_force -= from_contacts(row_of_body(world, plate));
    return balance;
}

} // namespace bris
