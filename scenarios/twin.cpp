// Twin experiment: the sensor rocks of a true triaxial test are recorded, and a model of it with
// other parameters is run without and with the recordings. The experiment measures how much better
// the model then predicts the other rocks. The model may also have rocks of other shapes, rocks in
// other positions, or another packing.
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/twin_experiment.hpp"
#include "scenarios/ensemble/twin_variants.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

void check_options(const TwinSettings& t, const Common& common) {
    require(t.triaxial.confining_pressure.size() == 1,
            "--confining-pressure: expected one pressure, found several");
    const bool faulty = t.sensors.faults.dropout > 0 || t.sensors.faults.outliers > 0;
    require(t.record.empty() || !faulty,
            "--record: expected no --dropout or --outliers, which are not recorded");
    require(t.sensors.mode != SensorMode::inertial || !faulty,
            "--sensor-mode inertial: expected no --dropout or --outliers, which apply to tracked "
            "sensors only");
    const bool moved = t.mismatch.placement > 0 || t.mismatch.rotation > 0;
    require(
        t.mismatch.packing == 0 || !moved,
        "--model-packing: expected no --model-placement or --model-rotation, which move rocks from "
        "the positions of the truth");
    require(t.mismatch.packing == 0 || t.mismatch.packing != common.seed,
            "--model-packing: expected another seed than --seed");
    require(t.mismatch.packing == 0 || !t.layouts,
            "--layouts: expected no --model-packing, whose rocks are not the rocks of the truth");
    require(!t.layouts || std::ranges::any_of(variants_in(t.variants), is_computed),
            "--layouts: expected analysis among the --variants, found none");
    require(t.mismatch.spheres == 0 || t.mismatch.spheres >= 4,
            fmt::format("--model-spheres: expected 0 or 4 and more, found {}", t.mismatch.spheres));
    check_test(t.triaxial);
    require_memory_for(t.triaxial, common.threads, common.memory_limit);
    require_same_specimen(common);
    say_how_read(grading_named(t.triaxial.grading));
}

void run(const TwinSettings& t, const Common& common) {
    TwinExperiment experiment(t, common);
    experiment.run();
    experiment.report();
    remove_checkpoints(common);
}

std::string explain(const TwinSettings& t, const Common& common) {
    return explain_triaxial(t.triaxial, common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::TwinSettings>(
        argc, argv,
        {.name = "twin",
         .description =
             "Simulates a triaxial test as the truth, records its sensor rocks, and shows how much "
             "better another model predicts all rocks with the recordings than without them.",
         .makes_beds = true},
        bris::check_options, bris::run, bris::explain);
}
