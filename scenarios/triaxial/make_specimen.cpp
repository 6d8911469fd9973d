#include "scenarios/triaxial/make_specimen.hpp"

#include <algorithm>
#include <array>

namespace bris {

namespace {

/// The settings on which a specimen depends.
std::vector<NamedValue> settings_of_specimen(const std::vector<NamedValue>& all) {
    constexpr std::array names{"seed",
                               "bodies",
                               "grading",
                               "porosity",
                               "porosity_tolerance",
                               "initial_porosity",
                               "compaction_friction",
                               "compaction_pressure_Pa",
                               "vibration",
                               "longest_compaction",
                               "sensor_shape",
                               "sensor_density_kg_per_m3",
                               "sensor_friction",
                               "sensor_poses",
                               "recordings",
                               "servo_per_element",
                               "density_kg_per_m3",
                               "clump_stiffness_N_per_m",
                               "wall_stiffness_N_per_m",
                               "damping",
                               "safety",
                               "model_specimen"};
    std::vector<NamedValue> some;
    std::ranges::copy_if(all, std::back_inserter(some),
                         [&](const NamedValue& v) { return std::ranges::count(names, v.key) > 0; });
    return some;
}

} // namespace

MadeSpecimen make_specimen(const TriaxialScene& scene, const TriaxialSettings& settings,
                           const Common& common, const ReportProgress& report,
                           const std::function<void(Simulation&, TriaxialTest&)>& begin) {
    Common of_specimen = common;
    of_specimen.scenario = "specimen";
    of_specimen.settings = settings_of_specimen(common.settings);
    Simulation simulation = make_simulation(scene, common.threads, common.serial);
    TriaxialTest test(simulation, settings);
    Run run(simulation, of_specimen, "specimen", report);
    if (std::filesystem::is_directory(common.resume))
        run.resume(common.resume / specimen_file);
    else if (!common.resume.empty())
        run.resume(common.resume);
    else if (begin)
        begin(simulation, test);
    const auto is_made = [&] { return test.state().phase >= TriaxialPhase::consolidate; };
    run.go({{.advance = [&](Simulation&) { return !is_made() && test.advance() && !is_made(); },
             .progress = [&](const World&) { return test.progress(); }}});
    return {simulation.snapshot(), test.state().prepared_porosity,
            simulation.world().resource<Clock>().step, simulation.count()};
}

} // namespace bris
