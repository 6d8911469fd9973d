// Twin experiment: a true triaxial test whose sensor rocks are recorded, and a model of it with other parameters that is
// run without and with the recordings. Does the model then know better what the other rocks do? Beside them a run with
// the true parameters from a start disturbed by less than a grain of dust: no model can know more than that.
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "systems/experiments/names.hpp"
#include "systems/output/plot.hpp"
#include "systems/procedure/twin.hpp"

#include <fmt/format.h>

#include <array>

namespace bris {

namespace {

struct Twin {
    Triaxial triaxial;
    double model_friction = 0.5, model_stiffness = 1, disturbance = 1e-7;
    TwinArm fused;
    std::string filter = "corrected";

    Twin() {
        triaxial.confining_pressure = {55e3};
        triaxial.test.final_axial_strain = 0.025;
        // velocities are known to be none at stage ends, and forgotten in between
        fused.filter.acceleration_density = 1;
        fused.filter.angular_acceleration_density = 100;
        fused.pull.largest_force = 100; // about the contact forces at 55 kPa
        fused.filter.drift = 1e-5; // 0.03 mm in a stage of 0.01 %
        fused.filter.turning = 0.1;
        fused.filter.gate = 1;
    }
    void describe(auto& option) {
        option.group("twin");
        option("model_friction", model_friction, "", "of rocks in the model; the truth's is --friction", at_least(0));
        option("model_stiffness", model_stiffness, "", "of contacts in the model, of the truth's", above(0));
        option("disturbance", disturbance, "m", "of all places, in the run that shows chaos alone", at_least(0));
        option("filter", filter, "", "what turns recordings into corrections", {"corrected", "error_state"});
        option("interval", fused.interval, "", "axial strain between samples", above(0));
        option("injection_steps", fused.injection_steps, "", "in which a correction enters; 1: it jumps, as in the report", at_least(1));
        option("spread", fused.spread, "", "corrections over the contact network, else sensor rocks move alone, as in the report");
        option("pull_stiffness", fused.pull.stiffness, "N/m", "of forces that pull sensor rocks; 0: they are put", at_least(0));
        option("largest_pull", fused.pull.largest_force, "N", "of them", at_least(0));
        option("position_noise", fused.position_noise, "m", "of the recordings", above(0));
        option("attitude_noise", fused.attitude_noise, "rad", "of the recordings", above(0));
        option("drift", fused.filter.drift, "m2", "that the model may go astray in a unit of strain", at_least(0));
        option("turning", fused.filter.turning, "rad2", "likewise", at_least(0));
        triaxial.describe(option);
    }
};

Archive prepare(const Triaxial& t, const TriaxialScene& scene, Progress& progress) {
    Simulation simulation = make_simulation(scene, 1, false);
    TriaxialTest test(simulation, t.test);
    while (test.state().phase < TriaxialPhase::consolidate) {
        test.advance();
        progress.report(0, test.fraction(), "specimen: " + test.description());
    }
    return simulation.snapshot();
}

constexpr std::array shell_names{"sensors", "shell_1", "shell_2", "shell_3", "shell_4"};

void add_errors(Summary& summary, const std::string& name, const TwinErrors& e) {
    summary.add(name + "_rmse_q_Pa", e.q);
    summary.add(name + "_rmse_volumetric_strain", e.volumetric_strain);
    summary.add(name + "_rmse_ring_radius_m", e.ring_radius);
    for (std::size_t s = 0; s < shell_names.size(); ++s) summary.add(fmt::format("{}_rmse_displacement_{}_m", name, shell_names[s]), e.displacement[s]);
    for (std::size_t s = 0; s < shell_names.size(); ++s) summary.add(fmt::format("{}_rmse_rotation_{}_rad", name, shell_names[s]), e.rotation[s]);
}

Curve curve_of(const std::string& label, const TwinRun& run, double scale, double TriaxialPoint::* value) {
    Curve c{.label = label};
    for (const TriaxialPoint& p : run.points) {
        c.x.push_back(100 * p.axial_strain);
        c.y.push_back(scale * p.*value);
    }
    return c;
}

void run(const Twin& t, const Common& common) {
    require(t.triaxial.confining_pressure.size() == 1, "--confining-pressure: expected one, found several");
    require(common.resume.empty(), "--resume: expected none");
    const TriaxialScene scene = make_scene(t.triaxial, common.seed);
    if (common.explain) {
        fmt::print("{}", make_simulation(scene, 1, common.serial).schedule().explain());
        return;
    }
    TriaxialSettings settings = t.triaxial.test;
    settings.confining_pressure = t.triaxial.confining_pressure.front();
    Progress progress(3, common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
    const Archive specimen = prepare(t.triaxial, scene, progress);
    const auto watch = [&](unsigned slot, const std::string& name) {
        return [&progress, slot, name](double fraction, const std::string& text) { progress.report(slot, fraction, name + ": " + text); };
    };
    TwinArm true_arm;
    true_arm.friction = settings.friction;
    const TwinRun truth = run_arm(scene, settings, specimen, true_arm, nullptr, common.seed, watch(0, "truth"));
    std::array<TwinArm, 3> arms{true_arm, true_arm, t.fused};
    arms[0].name = "free";
    arms[1].name = "chaos";
    arms[1].disturbance = t.disturbance;
    arms[2].name = "fused";
    arms[2].fused = true;
    arms[2].filter.kind = named<FilterKind>(filter_names, t.filter);
    for (const std::size_t k : {0u, 2u}) {
        arms[k].friction = t.model_friction;
        arms[k].stiffness = t.model_stiffness;
    }
    std::array<TwinRun, 3> runs;
    run_ensemble(arms.size(), common.threads, [&](std::size_t k) {
        runs[k] = run_arm(scene, settings, specimen, arms[k], &truth, common.seed, watch(static_cast<unsigned>(k), arms[k].name));
    });
    progress.pause();
    Summary summary;
    std::array<TwinErrors, 3> errors;
    for (std::size_t k = 0; k < arms.size(); ++k) add_errors(summary, arms[k].name, errors[k] = errors_of(runs[k], truth));
    const TwinErrors &free = errors[0], &fused = errors[2];
    summary.add("error_left_q", fused.q / free.q);
    summary.add("error_left_volumetric_strain", fused.volumetric_strain / free.volumetric_strain);
    summary.add("error_left_ring_radius", fused.ring_radius / free.ring_radius);
    for (std::size_t s = 0; s < shell_names.size(); ++s) summary.add(fmt::format("error_left_displacement_{}", shell_names[s]), fused.displacement[s] / free.displacement[s]);
    for (std::size_t s = 0; s < shell_names.size(); ++s) summary.add(fmt::format("error_left_rotation_{}", shell_names[s]), fused.rotation[s] / free.rotation[s]);
    summary.add("fusion_work_J", runs[2].fusion_work);
    summary.add("fusion_work_over_boundary_work", runs[2].fusion_work / runs[2].platen_work);
    summary.add("measurements_accepted", runs[2].accepted);
    summary.add("measurements_refused", runs[2].refused);
    summary.add("free_wall_time_s", runs[0].wall_time);
    summary.add("fused_wall_time_s", runs[2].wall_time);
    summary.add("free_steps", runs[0].steps);
    summary.add("fused_steps", runs[2].steps);
    const auto panel = [&](const char* title, double scale, double TriaxialPoint::* value) {
        Plot plot{.title = title, .x_label = "axial strain (%)", .y_label = title, .curves = {curve_of("truth", truth, scale, value)}};
        for (std::size_t k = 0; k < arms.size(); ++k) plot.curves.push_back(curve_of(arms[k].name, runs[k], scale, value));
        return plot;
    };
    draw_plots(common.out / "twin.png", {panel("q (kPa)", 1e-3, &TriaxialPoint::deviatoric_stress), panel("volumetric strain (%)", 100, &TriaxialPoint::volumetric_strain)});
    report_results(common, summary);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Twin>(argc, argv, "twin", "a true triaxial test, recorded, and a model of it without and with the recordings", bris::run);
}
