#include "scenarios/specimens/start.hpp"

#include "scenarios/specimens/check_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/steps.hpp"

namespace bris {

Simulation start(World world, const StartSettings& s) {
    check_scene(world, s.law);
    return start_unchecked(std::move(world), s);
}

Simulation start_unchecked(World world, const StartSettings& s) {
    add_lists(world, s.law, s.lists);
    if (s.energy_budget) add_energy_budget(world);
    const PatchStiffness patch = world.resource<Materials>().policy.patch;
    Simulation simulation(std::move(world), steps(s.law, s.energy_budget, patch), s.threads,
                          s.schedule);
    simulation.on_restore(forget_lists);
    if (s.sleep > 0) {
        const double weight = simulation.world().resource<Gravity>().value.norm();
        add_sleep(simulation.world(), {.acceleration = s.sleep * weight});
        simulation.prepare();
    }
    return simulation;
}

} // namespace bris
