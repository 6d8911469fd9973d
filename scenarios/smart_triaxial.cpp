// SMART computing of a recorded triaxial test: a model of the test estimates the friction and
// stiffness of the rocks from the recordings of a test machine and of SmartRocks, in the order in
// which they were measured, and is compared with the model alone.
#include "engine/assets.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/generations.hpp"
#include "scenarios/ensemble/learning_results.hpp"
#include "scenarios/ensemble/misfit.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/library/library_member.hpp"
#include "scenarios/library/library_use.hpp"
#include "scenarios/library/ring_estimate.hpp"
#include "scenarios/library/smart_results.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/specimens/write_option.hpp"
#include "systems/output/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace bris {

namespace {

struct Smart {
    Triaxial triaxial{.test = {.preparation = "report"}}; // as the example's specimen
    std::filesystem::path recordings = assets_folder() / "smartrock";
    std::filesystem::path library = assets_folder() / "libraries";
    RockParameters model{0.5, 1};
    Learning learning{.specimen_scatter = 0.35, .by_volume = true};
    Corrections corrections;
    QualityControlSettings quality_control;
    WriteOption written;
    unsigned running_members = 1;
    double change = 0.03, stage_time = 1.2, displacement_deviation = 1e-3, rotation_deviation = 0.1;

    Smart() {
        corrections.filter.gate = 0.999;
        corrections.nudging = {0, 100, 0.01};
    }
    void declare_options(auto& option) {
        option.group("Recordings");
        option("recordings", recordings, "",
               "Folder of the recordings: rock_NN.txt for each sensor, and for each pressure a "
               "folder such as 55kPa with recordings.csv (or recordings.h5) and test.csv.");
        option("columns", quality_control.columns, "",
               "File that maps the columns of recordings.csv if another program wrote it: names, "
               "units, signs, delimiter. Default: columns.txt in the folder, if it is there.");
        option("machine_columns", quality_control.machine_columns, "",
               "File that maps the columns of test.csv in the same way. Default: "
               "machine_columns.txt in the folder, if it is there.");
        option("rest", quality_control.rest, "s",
               "Time at the beginning of the recordings during which the rocks are at rest.",
               above(0, 1e6));
        option("use_displacement", quality_control.displacement, "",
               "Use the displacements ux, uy, uz where they were recorded. An inertial sensor "
               "alone does not observe displacements.");
        option("use_attitude", quality_control.attitude, "",
               "Use the attitudes qw, qx, qy, qz where they were recorded. Otherwise only the tilt "
               "relative to gravity is used.");
        option.group("Model");
        option("model_friction", model.friction, "",
               "Friction coefficient between rocks in the prior (the median).", above(0, 100));
        option("model_stiffness", model.stiffness, "",
               "Contact stiffness in the prior (the median), relative to --clump-stiffness.",
               above(0, 1e6));
        learning.declare_options(option);
        option(
            "library", library, "",
            "Library of specimens (specimen_library), from which the beginning of each test "
            "predicts "
            "the rest of it, if the library fits the model: this prediction is the result (fused). "
            "A file, or a folder of libraries, of which the one is used that fits. none, or where "
            "none fits: a model that takes over the estimated friction and stiffness.");
        option("running_members", running_members, "",
               "Number of specimens of the library, those that the beginning of a test favours "
               "most, that are made again and go on with the test as DEM models.",
               within(1, 100));
        option("change", change, "",
               "Relative change of the estimated friction or stiffness from which the model takes "
               "over the new estimate.",
               above(0, 10));
        option.group("Corrections of sensor rocks");
        option("nudging_stiffness", corrections.nudging.stiffness, "N/m",
               "Stiffness of the critically damped springs that nudge sensor rocks. 0: their poses "
               "are compared but not corrected.",
               within(0, 1e15));
        option("largest_nudging_force", corrections.nudging.largest_force, "N",
               "Largest force of spring and dashpot together.", within(0, 1e9));
        option("interval", quality_control.interval, "", "Axial strain between samples.",
               above(0, 1));
        option("displacement_deviation", displacement_deviation, "m",
               "Standard deviation of the model's displacements at the end of the test, for the "
               "report on observability.",
               above(0, 1));
        option("rotation_deviation", rotation_deviation, "rad",
               "Standard deviation of the model's rotations at the end of the test, for the report "
               "on observability.",
               above(0, 10));
        option("stage_time", stage_time, "s",
               "Time that the real test took for 0.01 % of axial strain.", above(0, 1e6));
        triaxial.declare_options(option);
        option.group("Files");
        written.declare_options(option, write_of_clumps);
    }
};

class Computation {
public:
    Computation(const Smart& settings, const Common& common, TriaxialScene scene,
                std::vector<RecordedTest> tests)
        : s_(settings), common_(common), tests_(std::move(tests)), scene_(std::move(scene)),
          progress_(make_progress(common)), done_(tests_.size()), frames_(tests_.size()) {}
    void run();
    void report();

private:
    TriaxialSettings settings_at(double pressure) const {
        TriaxialSettings settings = s_.triaxial.test;
        settings.confining_pressure = pressure;
        return settings;
    }
    /// A run of a test: of the model alone, or of the K-th of those that go on with the test.
    struct Job {
        std::size_t test;
        std::optional<std::size_t> running;
    };
    void predict_from_library();
    void prepare();
    void learn();
    void run_variants();
    ModelVariant fused_variant(std::size_t test) const;
    ModelRun run_job(const Job& job, const ModelWatch& watch);
    SmartResults results() const {
        return {s_.learning.final_strain, s_.triaxial.test.final_axial_strain,
                s_.corrections.nudging.stiffness > 0, &library_};
    }
    /// Tests that the library does not predict.
    std::size_t to_learn() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(done_, [](const SmartTest& t) { return !t.by_library(); }));
    }
    /// Number of points of a model run to an axial strain: at the start, and one for each stage.
    double points_to(double strain) const {
        const TriaxialSettings& test = s_.triaxial.test;
        return 1 + std::round(std::min(strain, test.final_axial_strain) / test.stage_strain);
    }
    double work_of_variants() const {
        double runs = 0;
        for (const SmartTest& t : done_)
            runs += 1 + (t.by_library() ? static_cast<double>(t.members.size()) : 1);
        return runs * points_to(s_.triaxial.test.final_axial_strain);
    }
    void show_trust(Report& summary) const;
    void show(std::size_t test, const World& world, double strain);
    std::unique_ptr<FrameWriter> make_frames(const RecordedTest& test) const;

    const Smart& s_;
    const Common& common_;
    std::vector<RecordedTest> tests_;
    TriaxialScene scene_;
    Progress progress_;
    Archive specimen_;
    std::filesystem::path library_file_;
    SpecimenLibrary library_;
    std::map<std::size_t, PreparedSpecimen> packings_; // of the library's specimens that run
    std::vector<SmartTest> done_;
    std::vector<std::unique_ptr<FrameWriter>> frames_; // by test
    double preparation_wall_ = 0, learning_wall_ = 0, variants_wall_ = 0;
};

/// Predicts each test before anything is simulated, which takes milliseconds.
void Computation::predict_from_library() {
    if (!is_given(s_.library)) {
        for (SmartTest& t : done_) t.library.not_used = t.rings.not_made = "none was given";
        return;
    }
    std::vector<ModelOfTest> models;
    for (const RecordedTest& test : tests_)
        models.push_back({common_.settings, s_.triaxial.test.core_porosity(), test.pressure});
    LibraryOfFile read = read_fitting_library(s_.library, models);
    library_file_ = std::move(read.file);
    library_ = std::move(read.library);
    report_news(common_, "library of specimens: " + library_file_.string());
    for (std::size_t k = 0; k < tests_.size(); ++k) {
        const std::string folder = folder_of(tests_[k].pressure);
        const RecordedTest& test = tests_[k];
        const ModelOfTest& model = models[k];
        TestPrediction& predicted = done_[k].library;
        predicted =
            predict_test(library_, model, test.curves, {.strain = s_.learning.final_strain}, true);
        report_news(common_, fmt::format("{}: {}", folder, sentence_of(predicted)));
        if (!predicted.not_used.empty()) continue;
        require(s_.corrections.nudging.stiffness <= 0,
                "--nudging-stiffness: expected --library none; where a library predicts the test, "
                "no model is nudged");
        done_[k].members = favoured(predicted.weights, s_.running_members);
        report_news(common_, fmt::format("{}: the specimens that go on with the test: {}", folder,
                                         sentence_of(library_, done_[k].members)));
        write_prediction(common_.out / folder / "predicted.csv", predicted.predicted.curves);
        RingEstimate& rings = done_[k].rings;
        rings = estimate_rings(library_, model, test, test.curves[quantity::axial_strain].back());
        report_news(common_, fmt::format("{}: {}", folder, sentence_of(rings)));
        if (rings.not_made.empty())
            write_rings(common_.out / folder / "rings.csv", rings,
                        ring_strains(test.curves, rings.strain));
    }
}

/// Makes the specimen of the model and those of the library that go on with the tests, each on one
/// thread; without the latter the former on all threads.
void Computation::prepare() {
    const auto began = this_instant();
    for (const SmartTest& t : done_)
        for (const FavouredSpecimen& m : t.members) packings_.try_emplace(m.index);
    std::vector<std::size_t> members;
    for (const auto& [index, packing] : packings_) members.push_back(index);
    Common own = common_;
    if (!members.empty()) own.threads = 1;
    const Triaxial of_library = members.empty() ? Triaxial{} : test_of(library_);
    const auto make = [&](std::size_t job) {
        const auto report = progress_slot(progress_, static_cast<unsigned>(job));
        if (job == 0) {
            specimen_ =
                make_specimen(scene_, settings_at(tests_.front().pressure), own, report).state;
            return;
        }
        const LibrarySpecimen& s = library_.specimens[members[job - 1]];
        packings_.at(members[job - 1]) =
            make_packing(of_library, {s.porosity, s.seed}, library_.settings, common_, report);
    };
    run_ensemble(1 + members.size(), common_.threads, make);
    progress_.pause();
    preparation_wall_ = seconds_since(began);
}

void report_learned(const Common& common, const std::string& test,
                    const std::vector<EstimateAt>& estimates) {
    std::string text;
    if (!estimates.empty())
        for (const NamedValue& v : named_values_of(estimates.back().estimate))
            text += fmt::format("{}{} {:.3f}", text.empty() ? "" : ", ", v.key,
                                std::get<double>(v.value));
    report_news(common,
                fmt::format("{}: {}", test,
                            text.empty()
                                ? "nothing was learned, the model keeps its friction and stiffness"
                                : text));
}

// All tests have the same specimen, whose error is nearly the same at all pressures (correlation
// 0.9), so three tests give no more certainty than one. Each estimation therefore begins with the
// prior from before all tests, while the model of a test begins with the estimate of the test
// before it. Tests that the library predicts are left out.
void Computation::learn() {
    const auto began = this_instant();
    const Gaussian prior = prior_of(s_.model, s_.learning);
    RockParameters now = s_.model;
    double done = 0;
    progress_.begin_job(
        static_cast<double>(to_learn()) * s_.learning.members *
            (points_to(s_.learning.first_strain) + points_to(s_.learning.final_strain)) +
        work_of_variants());
    for (std::size_t k = 0; k < tests_.size(); ++k) {
        done_[k].before = now;
        if (done_[k].by_library()) continue;
        done_[k].learned = learn_in_two_generations(
            prior, tests_[k], s_.learning, s_.learning.final_strain,
            [&](const std::vector<ModelVariant>& variants, double strain) {
                auto runs = try_models(scene_, settings_at(tests_[k].pressure), specimen_, variants,
                                       strain, common_, progress_);
                progress_.job_reached(done +=
                                      static_cast<double>(variants.size()) * points_to(strain));
                return runs;
            });
        if (!done_[k].learned.estimates.empty())
            now = mean_of(done_[k].learned.estimates.back().estimate);
        report_learned(common_, folder_of(tests_[k].pressure), done_[k].learned.estimates);
        write_estimates(common_.out / folder_of(tests_[k].pressure) / "learned.csv",
                        done_[k].learned.estimates);
    }
    learning_wall_ = seconds_since(began);
}

std::unique_ptr<FrameWriter> Computation::make_frames(const RecordedTest& test) const {
    auto settings = common_.settings;
    settings.emplace_back("quality_control", quality_control_report(test));
    return std::make_unique<FrameWriter>(common_.out / folder_of(test.pressure) /
                                             "smart_triaxial.vtkhdf",
                                         settings, s_.written.extras());
}

void Computation::show(std::size_t test, const World& world, double strain) {
    const auto stage =
        static_cast<std::size_t>(std::llround(strain / s_.triaxial.test.stage_strain));
    const auto stages = static_cast<std::size_t>(
        std::llround(s_.triaxial.test.final_axial_strain / s_.triaxial.test.stage_strain));
    const bool shown = stage == 0 || stage == stages / 2 || stage == stages;
    if (stage % s_.triaxial.frame_stages != 0 && !shown) return;
    if (!frames_[test]) frames_[test] = make_frames(tests_[test]);
    BodyFrame frame = frame_of_bodies(world);
    frames_[test]->add(world, frame);
    if (!shown) return;
    const auto& sensors = world.resource<Specimen>().smart_rocks;
    frame.ids.assign(sensors.begin(), sensors.end());
    View view = view_of_bodies(world, frame, [&](std::size_t index) {
        return rock_colour(static_cast<std::uint32_t>(3 * index));
    });
    view.caption = fmt::format("{:.1f} %", 100 * strain);
    done_[test].views.push_back(std::move(view));
}

/// Adds the last estimate to the schedule of a variant, however uncertain it is, since no better
/// one follows.
void append_final_estimate(ModelVariant& variant, const std::vector<EstimateAt>& estimates) {
    if (estimates.empty()) return;
    const RockParameters applied =
                             variant.learned.empty() ? variant.rocks : variant.learned.back().rocks,
                         last = mean_of(estimates.back().estimate);
    if (applied.friction != last.friction || applied.stiffness != last.stiffness)
        variant.learned.push_back({estimates.back().strain, last});
}

/// The model that takes over its estimates while it runs.
ModelVariant Computation::fused_variant(std::size_t k) const {
    const RockParameters& first = done_[k].before;
    ModelVariant fused{.name = "fused",
                       .rocks = first,
                       .learned = schedule_of(done_[k].learned.estimates, first, s_.change),
                       .corrections = s_.corrections};
    append_final_estimate(fused, done_[k].learned.estimates);
    fused.corrections.position_noise = fused.corrections.attitude_noise = 0;
    for (const Recording& r : tests_[k].recordings) { // the noise of the worst sensor
        fused.corrections.position_noise =
            std::max(fused.corrections.position_noise, r.info.displacement_noise);
        fused.corrections.attitude_noise =
            std::max(fused.corrections.attitude_noise, r.info.attitude_noise);
    }
    if (s_.corrections.nudging.stiffness > 0) fused.trajectories = tests_[k].trajectories;
    return fused;
}

ModelRun Computation::run_job(const Job& job, const ModelWatch& watch) {
    const SmartTest& t = done_[job.test];
    const TriaxialSettings settings = settings_at(tests_[job.test].pressure);
    if (job.running && t.by_library()) {
        const std::size_t index = t.members[*job.running].index;
        return run_member(library_, index, packings_.at(index), settings.confining_pressure,
                          settings.final_axial_strain, watch);
    }
    if (job.running) // no checkpoint: its pictures are taken during the run
        return run_model(scene_, settings, specimen_, fused_variant(job.test), watch);
    const ModelVariant alone{.name = "DEM only", .rocks = s_.model};
    CheckpointedRun checkpoint(common_, settings, specimen_, alone);
    return run_model(scene_, settings, specimen_, alone, watch, &checkpoint);
}

void Computation::run_variants() {
    const auto began = this_instant();
    std::vector<Job> jobs;
    for (std::size_t k = 0; k < tests_.size(); ++k) {
        jobs.push_back({k, std::nullopt});
        done_[k].running.resize(done_[k].by_library() ? done_[k].members.size() : 1);
        for (std::size_t m = 0; m < done_[k].running.size(); ++m) jobs.push_back({k, m});
    }
    run_ensemble(jobs.size(), common_.threads, [&](std::size_t j) {
        const Job& job = jobs[j];
        ModelWatch watch = watch_on(progress_, j);
        if (job.running == 0)
            watch.stage = [&](const World& world, double strain) { show(job.test, world, strain); };
        ModelRun& run = job.running ? done_[job.test].running[*job.running] : done_[job.test].free;
        try {
            run = run_job(job, watch);
        } catch (const SimulationError& error) { // the other runs continue
            run.stopped = fmt::format("{} at {}: {}", job.running ? "fused" : "DEM only",
                                      folder_of(tests_[job.test].pressure), error.what());
        }
    });
    progress_.pause();
    variants_wall_ = seconds_since(began);
}

void Computation::run() {
    predict_from_library();
    prepare();
    learn();
    run_variants();
}

/// Says what the rows mean and what was not used.
void Computation::show_trust(Report& summary) const {
    summary.show_sentence("Error ratios are those of the fused prediction over those of DEM only, "
                          "beyond the strains learned from. Bands are those of 90 %.");
    for (const RecordedTest& test : tests_)
        if (test.refused() > 0 || refused_channels(test) != "none")
            summary.show_sentence(
                fmt::format("{}: {}.", folder_of(test.pressure), verdict_on(test)));
    summary.show_sentence("What each sensor observes is in quality_control.txt; the curves are in "
                          "smart_triaxial.png.");
}

void Computation::report() {
    Report summary;
    if (!library_file_.empty()) summary.add("library_file", library_file_.string());
    std::string stopped;
    const auto note = [&](const ModelRun& run) {
        if (!run.stopped.empty()) stopped += (stopped.empty() ? "" : "; ") + run.stopped;
    };
    for (std::size_t k = 0; k < tests_.size(); ++k) {
        const SmartTest& t = done_[k];
        write_runs(common_.out / folder_of(tests_[k].pressure), t, results());
        add_results(summary, tests_[k], t, results());
        note(t.free);
        std::ranges::for_each(t.running, note);
    }
    summary.add("preparation_wall_time_s", preparation_wall_);
    summary.add("learning_wall_time_s", learning_wall_);
    summary.add("tests_wall_time_s", variants_wall_);
    draw_results(common_.out, tests_, done_, s_.learning.final_strain);
    summary.show({"preparation_wall_time_s", "tests_wall_time_s"});
    show_trust(summary);
    report_results(common_, summary);
    if (!stopped.empty()) throw SimulationError(stopped);
}

/// Reads the tests and runs their quality control. The verdict is reported now, because the
/// computation takes long.
std::vector<RecordedTest> judged_tests(const Smart& s, const Common& common,
                                       const std::vector<SensorInfo>& infos) {
    std::vector<RecordedTest> tests;
    std::string report;
    const double duration = s.triaxial.test.final_axial_strain / 1e-4 * s.stage_time;
    for (const double pressure : s.triaxial.confining_pressure) {
        tests.push_back(read_recorded_test(s.recordings, pressure, infos, s.quality_control));
        RecordedTest& test = tests.back();
        test.curves = MeasuredCurves(test.curves.up_to(s.triaxial.test.final_axial_strain +
                                                       0.5 * s.triaxial.test.stage_strain));
        report += fmt::format(
            "{}{}\n{}\n{}", report.empty() ? "" : "\n\n", folder_of(pressure),
            quality_control_report(test),
            observability_report(test, duration, s.displacement_deviation, s.rotation_deviation));
    }
    for (const RecordedTest& test : tests) {
        std::filesystem::create_directories(common.out / folder_of(test.pressure));
        report_news(common, fmt::format("{}: {}", folder_of(test.pressure), verdict_on(test)));
    }
    write_whole(common.out / "quality_control.txt", report);
    return tests;
}

std::string explain(const Smart& given, const Common& common) {
    return explain_triaxial(with_recorded_poses(given.triaxial, given.recordings), common);
}

void check_options(const Smart& given, const Common& common) {
    Smart s = given;
    s.triaxial = with_recorded_poses(given.triaxial, given.recordings);
    check_test(s.triaxial);
    refuse_friction(s.triaxial);
    require_memory_for(s.triaxial, common.threads, common.memory_limit);
    require_same_specimen(common);
    say_how_read(grading_named(s.triaxial.grading));
    const auto infos = read_sensor_infos(s.recordings);
    require_sensor_for_each(make_scene(s.triaxial, common.seed).poses, infos);
    std::vector<ModelOfTest> models;
    for (const double pressure : s.triaxial.confining_pressure) {
        (void)read_recorded_test(s.recordings, pressure, infos, s.quality_control);
        models.push_back({common.settings, s.triaxial.test.core_porosity(), pressure});
    }
    if (is_given(s.library)) (void)read_fitting_library(s.library, models);
}

void run(const Smart& given, const Common& common) {
    Smart s = given;
    s.triaxial = with_recorded_poses(given.triaxial, given.recordings);
    const auto infos = read_sensor_infos(s.recordings);
    TriaxialScene scene = make_scene(s.triaxial, common.seed);
    const SavesWhenInterrupted saves("continue with --resume " + common.out.string());
    Computation computation(s, common, std::move(scene), judged_tests(s, common, infos));
    computation.run();
    computation.report();
    remove_checkpoints(common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Smart>(argc, argv,
                                           {.name = "smart_triaxial",
                                            .description = "Models a triaxial test recorded with "
                                                           "SmartRocks and learns from the "
                                                           "recordings during the run.",
                                            .makes_beds = true},
                                           bris::check_options, bris::run, bris::explain);
}
