#include "scenarios/ballast_box/box_balance.hpp"

#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/outer_force.hpp"

namespace bris {

BoxBalance box_balance(const World& world) {
    const OuterForces outer(world);
    const Balance all = compute_balance(world);
    BoxBalance balance{.unbalanced_ratio = all.unbalanced_ratio, .carries = carries_load(all)};
    const auto& of_box = world.resource<BoxBodies>();
    for (const EntityId tie : of_box.ties) {
        balance.tie_load -= outer(row_of_body(world, tie)).z();
        balance.tie_support += contact_force(world, tie).z();
    }
    for (const EntityId plate : of_box.subgrade)
        balance.subgrade_force -= contact_force(world, plate).z();
    return balance;
}

} // namespace bris
