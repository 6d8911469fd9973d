#include "scenarios/triaxial/trial.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t most_trials = 8;

TriaxialSettings trial_settings(const TriaxialSettings& preparation) {
    TriaxialSettings trial;
    trial.confining_pressure = preparation.trial_pressure;
    trial.friction = preparation.preparation_friction < 0 ? preparation.friction
                                                          : preparation.preparation_friction;
    trial.damping = preparation.damping;
    trial.safety = preparation.safety;
    return trial;
}

} // namespace

TrialConsolidation::TrialConsolidation(const TriaxialScene& scene, const TriaxialSettings& settings,
                                       const Archive& specimen, unsigned threads)
    : simulation_(make_simulation(scene, threads)), test_(simulation_, trial_settings(settings)) {
    simulation_.restore(specimen);
}

bool TrialConsolidation::advance() {
    (void)test_.advance();
    return test_.state().phase == TriaxialPhase::consolidate;
}

PhaseProgress TrialConsolidation::progress() const {
    PhaseProgress progress = test_.progress();
    progress.status = "trial consolidation, " + progress.status;
    progress.phase = "preparation";
    return progress;
}

void TriaxialTest::judge(double porosity_after_trial) {
    auto& state = simulation_.world().resource<TriaxialState>();
    const double off = porosity_after_trial - settings_.core_porosity();
    ++state.trials;
    state.accepted = std::abs(off) <= settings_.porosity_tolerance;
    if (state.accepted) return;
    if (state.trials >= most_trials)
        throw SimulationError(fmt::format(
            "preparation: expected a core porosity of {:.3f} +- {:.3f} at the start of shearing, "
            "found {:.4f} in the last of {} trial consolidations; choose a larger "
            "--porosity-tolerance or more rocks (--bodies)",
            settings_.core_porosity(), settings_.porosity_tolerance, porosity_after_trial,
            state.trials));
    state.aim -= off;
    return_to_mould();
    prepare_again(state.prepared_porosity - state.aim);
}

// Undoes what starts the consolidation. Masses stay as they are until the next block ends: a run
// resumed here knows no contacts, and would scale them differently.
void TriaxialTest::return_to_mould() {
    World& world = simulation_.world();
    const auto& specimen = world.resource<Specimen>();
    auto& membrane = world.resource<Membrane>();
    membrane.active = false;
    membrane.ring_height = specimen.height / membrane.rings;
    for (const EntityId id : specimen.smart_rocks)
        world.column<Bodies, MotionOf>()[row_of_body(world, id)] =
            static_cast<std::uint32_t>(Motion::prescribed);
    press_platen();
    invalidate_lists(world);
}

} // namespace bris
