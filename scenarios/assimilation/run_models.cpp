#include "scenarios/assimilation/run_models.hpp"

#include "engine/checkpoint_keeper.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "scenarios/assimilation/arm_run.hpp"
#include "scenarios/assimilation/kept_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

namespace bris {

namespace {

/// Settings that a specimen depends on.
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

std::string stopped_by(const SimulationError& error, const ModelArm& arm) {
    return fmt::format("{} (friction {:.3g}, stiffness {:.3g}): {}", arm.name, arm.rocks.friction,
                       arm.rocks.stiffness, error.what());
}

/// What an arm is run on.
struct Start {
    const TriaxialScene& scene;
    const Archive& specimen;
};

std::vector<ModelRun> try_from(const std::vector<Start>& starts, const TriaxialSettings& settings,
                               const std::vector<ModelArm>& arms, double strain,
                               const Common& common, Progress& progress) {
    TriaxialSettings test = settings;
    test.final_axial_strain = std::min(strain, test.final_axial_strain);
    std::vector<ModelRun> runs(arms.size());
    run_ensemble(arms.size(), common.threads, [&](std::size_t k) {
        const auto& [scene, specimen] = starts[k];
        KeptRun kept(common, test, specimen, arms[k]);
        try {
            runs[k] = run_model(scene, test, specimen, arms[k], common.seed,
                                watch_on(progress, k, common), &kept);
        } catch (const SimulationError& error) {
            runs[k].stopped = stopped_by(error, arms[k]);
        }
    });
    progress.pause();
    return runs;
}

/// Stages of a run that another one does not have yet, up to a number of points.
void add_stages(ModelRun& sum, const ModelRun& run, std::size_t points) {
    if (sum.points.empty()) sum = begun_like(run);
    for (std::size_t k = sum.points.size(); k < std::min(points, run.points.size()); ++k) {
        sum.points.push_back(run.points[k]);
        sum.displacement.push_back(run.displacement[k]);
        sum.rotation.push_back(run.rotation[k]);
    }
}

/// Runs that go on together.
class RunsTogether {
public:
    RunsTogether(const TriaxialScene& scene, const TriaxialSettings& settings,
                 const Archive& specimen, const std::vector<ModelArm>& arms, const Common& common,
                 Progress& progress)
        : scene_(scene), settings_(settings), specimen_(specimen), common_(common),
          progress_(progress) {
        for (const ModelArm& arm : arms)
            members_.push_back(std::make_unique<Member>(
                Member{KeptRun(common, settings_, specimen, arm), arm, nullptr}));
    }

    void go_on(std::vector<ModelRun>& runs, std::size_t points) {
        runs.resize(members_.size());
        const double whole = settings_.final_axial_strain / settings_.stage_strain;
        asked_ = std::min(1.0, static_cast<double>(points - 1) / whole);
        run_ensemble(members_.size(), common_.threads, [&](std::size_t k) {
            try {
                go_on(k, points);
                add_stages(runs[k], members_[k]->run->run(), points);
            } catch (const SimulationError& error) {
                runs[k].stopped = stopped_by(error, members_[k]->arm);
            }
        });
        for (std::size_t k = runs.size(); k-- > 0;)
            if (!runs[k].stopped.empty()) {
                progress_.pause();
                members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(k));
            }
    }
    void keep() {
        for (const auto& member : members_)
            if (member->run) member->run->keep();
    }

private:
    struct Member {
        KeptRun kept;
        ModelArm arm;
        std::unique_ptr<ArmRun> run; ///< null: not begun
    };
    void go_on(std::size_t k, std::size_t points) {
        Member& member = *members_[k];
        if (!member.run) {
            ModelWatch watch = watch_on(progress_, k, common_);
            watch.progress = [this, tell = watch.progress](double fraction,
                                                           const std::string& text) {
                tell(asked_ > 0 ? std::min(1.0, fraction / asked_) : 1, text);
            };
            member.run = std::make_unique<ArmRun>(scene_, settings_, specimen_, member.arm,
                                                  common_.seed, std::move(watch), &member.kept);
        }
        member.run->go_on_to(points);
    }

    const TriaxialScene& scene_;
    TriaxialSettings settings_;
    const Archive& specimen_;
    const Common& common_;
    Progress& progress_;
    double asked_ = 1; // part of the test
    std::vector<std::unique_ptr<Member>>
        members_; // each stays where it is: its run refers to what it is kept by
};

} // namespace

Archive make_specimen(const TriaxialScene& scene, const TriaxialSettings& settings,
                      const Common& common,
                      const std::function<void(double, const std::string&)>& watch,
                      const std::function<void(Simulation&, TriaxialTest&)>& begin) {
    constexpr auto file = "specimen.ckpt.h5";
    const auto of_specimen = settings_of_specimen(common.settings);
    Simulation simulation = make_simulation(scene, common.threads, common.serial);
    TriaxialTest test(simulation, settings);
    if (common.resume.empty() && begin) begin(simulation, test);
    if (!common.resume.empty())
        (void)resume(simulation,
                     std::filesystem::is_directory(common.resume) ? common.resume / file
                                                                  : common.resume,
                     "specimen", of_specimen);
    CheckpointKeeper keeper({common.out / file, "specimen", of_specimen});
    while (test.state().phase < TriaxialPhase::consolidate) {
        test.advance();
        watch(test.fraction(), "specimen: " + test.description());
        keeper.attend(simulation);
    }
    keeper.save(simulation);
    return simulation.snapshot();
}

Progress progress_of_models(const Common& common) {
    return Progress(std::max(2u, common.threads),
                    common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
}

ModelWatch watch_on(Progress& progress, std::size_t model, const Common& common) {
    const auto slot = static_cast<unsigned>(model % std::max(2u, common.threads));
    return {.progress = [&progress, slot](double fraction, const std::string& text) {
        progress.report(slot, fraction, text);
    }};
}

std::vector<ModelRun> try_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                                 const Archive& specimen, const std::vector<ModelArm>& arms,
                                 double strain, const Common& common, Progress& progress) {
    return try_from(std::vector<Start>(arms.size(), {scene, specimen}), settings, arms, strain,
                    common, progress);
}

std::vector<ModelRun> run_models(const std::vector<const PreparedSpecimen*>& specimens,
                                 const TriaxialSettings& settings,
                                 const std::vector<ModelArm>& arms, double strain,
                                 const Common& common, Progress& progress) {
    require(specimens.size() == arms.size(),
            fmt::format("models: expected a specimen for each of {} arms, found {}", arms.size(),
                        specimens.size()));
    std::vector<Start> starts;
    for (const PreparedSpecimen* specimen : specimens)
        starts.push_back({specimen->scene, specimen->state});
    auto runs = try_from(starts, settings, arms, strain, common, progress);
    for (const ModelRun& run : runs)
        if (!run.stopped.empty()) throw SimulationError(run.stopped);
    return runs;
}

RunsAtWork begin_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                        const Archive& specimen, const std::vector<ModelArm>& arms,
                        const Common& common, Progress& progress) {
    const auto together =
        std::make_shared<RunsTogether>(scene, settings, specimen, arms, common, progress);
    return {[together](std::vector<ModelRun>& runs, std::size_t points) {
                together->go_on(runs, points);
            },
            [together] { together->keep(); }};
}

} // namespace bris
