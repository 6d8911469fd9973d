#include "scenarios/specimens/start.hpp"

#include "engine/errors.hpp"
#include "engine/ranks.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/slabs/slabs.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/steps.hpp"

#include <fmt/format.h>

namespace bris {

Simulation start(World world, const StartSettings& s) {
    check_scene(world, s.law);
    if (const unsigned ranks = s.divides ? Ranks::size() : 1, most = most_slabs(world);
        ranks > most)
        throw InputError(
            fmt::format("--ranks: expected at most {} in this scene, as each rank has a "
                        "slab at least two of the largest bodies wide, found {}",
                        most, ranks));
    return start_unchecked(std::move(world), s);
}

void divide_among_ranks(Simulation& simulation) {
    if (Ranks::size() == 1) return;
    simulation.divide({.take =
                           [](World& whole) {
                               survey(whole);
                               World part = take_slab(whole);
                               forget_lists(part);
                               return part;
                           },
                       .give_back = give_back,
                       .whole_step_is_due = whole_step_is_due,
                       .rows_to_save = rows_to_save,
                       .can_be_observed = can_be_observed});
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
    if (s.divides) divide_among_ranks(simulation);
    return simulation;
}

} // namespace bris
