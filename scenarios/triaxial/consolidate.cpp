#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/balance.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr std::uint64_t least_steps = 1000; // before the first check of equilibrium

} // namespace

void TriaxialTest::begin_compacted() {
    World& world = simulation_.world();
    // as after compaction; the friction of the test acts from consolidation on
    set_friction(world, 0);
    world.resource<Gravity>().value.setZero();
    forget_lists(world); // bodies know the rows of their spheres from here on
    world.resource<TriaxialState>().prepared_porosity = porosity(world, core(world), 120);
    start_consolidation();
}

void TriaxialTest::start_consolidation() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& membrane = world.resource<Membrane>();
    auto& platen = world.resource<Platen>();
    const double top = platen_height(world);
    membrane.ring_height = top / membrane.rings;
    world.resource<LocalDamping>().fraction = settings_.damping;
    for (const EntityId id : world.resource<Specimen>().smart_rocks)
        world.column<Bodies, MotionOf>()[row_of_body(world, id)] =
            static_cast<std::uint32_t>(Motion::free);
    stop_rocks(world);
    if (settings_.gravity) world.resource<Gravity>().value = Vec3(0, 0, -9.81);
    membrane.active = platen.controlled = true;
    // the servos take the confining pressure at once, without a ramp from that of the preparation
    membrane.aim = platen.aim = {};
    membrane.contact_stiffness = platen.contact_stiffness = wall_contact_stiffness(world);
    membrane.largest_step = platen.largest_step = 2e-6 * top;
    // a node weighs so little that it does not throw rocks about at ten times that speed
    if (world.has<Nodes>()) membrane.largest_step *= 10;
    invalidate_lists(world);
    state.phase = TriaxialPhase::consolidate;
    state.phase_steps = 0;
    rescale();
}

void TriaxialTest::consolidate() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    // set here because one snapshot of a specimen serves for several pressures and frictions
    if (state.phase_steps == 0) set_friction(world, settings_.friction);
    world.resource<Membrane>().target_pressure = settings_.confining_pressure;
    world.resource<Platen>().target_pressure = settings_.confining_pressure;
    run(50);
    if (state.phase_steps % 500 == 0) rescale();
    if (state.phase_steps >= least_steps && is_in_equilibrium()) return start_shear();
    if (state.phase_steps > 10 * settings_.longest_stage)
        throw SimulationError(fmt::format("consolidation: no equilibrium after {} steps: {}",
                                          state.phase_steps, equilibrium_status()));
}

std::string TriaxialTest::consolidation_status() const {
    const std::uint64_t step = state().phase_steps;
    if (step < least_steps) return fmt::format("step {} of at least {}", step, least_steps);
    return fmt::format("{}, step {}", equilibrium_status(), step);
}

void TriaxialTest::start_shear() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& platen = world.resource<Platen>();
    state.height = platen_height(world);
    state.volume = specimen_volume(world);
    state.global_porosity =
        1 - solid_volume(world, {2 * membrane_radius(world), 0, state.height}, 240) / state.volume;
    state.core_porosity = porosity(world, core(world), 240);
    for (const SensorDrift& d : sensor_drift(world)) {
        state.drift = std::max(state.drift, (d.now - d.given).norm());
        state.rotation = std::max(state.rotation, d.rotation);
    }
    // not before: a large rock may still press a small one as it did while the specimen was tapped
    world.resource<Limits>().impact_allowance = 1;
    if (settings_.cycles.are_given()) return start_cycles();
    platen.controlled = false;
    platen.speed = 0;
    state.phase = TriaxialPhase::shear;
    state.stage = 0;
    state.phase_steps = 0;
    add_stage();
    rescale();
}

} // namespace bris
