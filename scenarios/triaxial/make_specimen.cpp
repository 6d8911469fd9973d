#include "scenarios/triaxial/make_specimen.hpp"

#include "engine/resume.hpp"
#include "scenarios/specimens/bed_store.hpp"
#include "scenarios/triaxial/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace bris {

namespace {

/// Number and hash of the poses in which the folder --recordings has its sensor rocks placed; "" if
/// poses come from elsewhere. A specimen depends on nothing else of the recordings.
std::string recorded_poses(const std::vector<NamedValue>& all) {
    const auto text = [&](const char* key) {
        const auto found = std::ranges::find(all, key, &NamedValue::key);
        const auto* value = found == all.end() ? nullptr : std::get_if<std::string>(&found->value);
        return value ? *value : std::string();
    };
    if (text("recordings").empty() || !text("sensor_poses").empty()) return {};
    Archive poses;
    std::vector<double> numbers;
    const auto given = with_recorded_poses({}, text("recordings")).recorded_poses;
    for (const GivenPose& p : given)
        for (const double x :
             {p.position.x(), p.position.y(), p.position.z(), p.orientation.w(), p.orientation.x(),
              p.orientation.y(), p.orientation.z(), p.is_relative ? 1.0 : 0.0})
            numbers.push_back(x);
    poses.put("poses", std::span<const double>(numbers));
    return fmt::format("{} ({:016x})", given.size(), fingerprint(poses));
}

/// The settings on which a specimen depends.
std::vector<NamedValue> settings_of_specimen(const std::vector<NamedValue>& all) {
    constexpr std::array names{"seed",
                               "bodies",
                               "grading",
                               "clumps",
                               "preparation",
                               "porosity",
                               "porosity_tolerance",
                               "preparation_friction",
                               "preparation_pressure_Pa",
                               "trial_pressure_Pa",
                               "longest_preparation",
                               "sensor_shape",
                               "sensor_density_kg_per_m3",
                               "sensor_friction",
                               "platen_friction",
                               "taps",
                               "sensor_poses",
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
    // a specimen for which no friction was given is made with that of its test
    for (NamedValue& v : some)
        if (v.key == "preparation_friction")
            if (const auto* given = std::get_if<double>(&v.value); given && *given < 0)
                v.value = std::ranges::find(all, "friction", &NamedValue::key)->value;
    if (const std::string poses = recorded_poses(all); !poses.empty())
        some.emplace_back("recorded_poses", poses);
    return some;
}

Common common_of_specimen(const Common& common) {
    Common own = common;
    own.scenario = "specimen";
    own.settings = settings_of_specimen(common.settings);
    if (std::filesystem::is_directory(common.resume)) own.resume /= specimen_file;
    return own;
}

} // namespace

void require_same_specimen(const Common& common) {
    const Common own = common_of_specimen(common);
    if (!own.resume.empty()) (void)checkpoint_to_resume(own.resume, own.scenario, own.settings);
}

MadeSpecimen make_specimen(const TriaxialScene& of_test, const TriaxialSettings& settings,
                           const Common& common, const ReportProgress& report,
                           const std::function<void(Simulation&, TriaxialTest&)>& begin) {
    const TriaxialScene scene = in_mould(of_test);
    Common of_specimen = common_of_specimen(common);
    if (begin) of_specimen.beds = "none"; // the settings do not say where it places the rocks
    Simulation simulation = make_simulation(scene, common.threads);
    TriaxialTest test(simulation, settings);
    Run run(simulation, of_specimen, "specimen", report);
    const BedStore store(of_specimen, simulation, "specimen");
    if (!store.from().empty())
        run.resume(store.from());
    else if (begin)
        begin(simulation, test);
    StepCount of_trials;
    std::optional<TrialConsolidation> trial; // not saved: a resumed run begins it again
    const auto is_prepared = [&] { return test.state().phase >= TriaxialPhase::consolidate; };
    const auto is_made = [&] { return is_prepared() && (begin || test.state().accepted); };
    const auto advance = [&](Simulation&) {
        if (is_made()) return false;
        if (!is_prepared()) return test.advance() && !is_made();
        if (!trial) trial.emplace(scene, settings, simulation.snapshot(), common.threads);
        if (trial->advance()) return true;
        test.judge(trial->core_porosity());
        of_trials.steps += trial->count().steps;
        of_trials.wall_time += trial->count().wall_time;
        trial.reset();
        return !is_made();
    };
    run.go({{.advance = advance, .progress = [&](const World&) {
                 return trial ? trial->progress() : test.progress();
             }}});
    store.keep(of_specimen.out / specimen_file);
    StepCount count = simulation.count();
    count.steps += of_trials.steps;
    count.wall_time += of_trials.wall_time;
    return {simulation.snapshot(), test.state().prepared_porosity,
            simulation.world().resource<Clock>().step, count,
            of_specimen.resume.empty() && !store.from().empty()};
}

} // namespace bris
