// Drained triaxial compression or load cycles of railway ballast (clumps of 30 spheres) inside a
// servo membrane of 8 rings x 12 elements, after the SmartRock report: one specimen is tested at
// each confining pressure.

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/report.hpp"
#include "engine/resume.hpp"
#include "engine/run.hpp"
#include "scenarios/specimens/fouling_options.hpp"
#include "scenarios/specimens/material_card_file.hpp"
#include "scenarios/specimens/write_option.hpp"
#include "scenarios/triaxial/cyclic_results.hpp"
#include "scenarios/triaxial/make_specimen.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/output/picture.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

/// A triaxial test, possibly with fines in the voids.
struct FouledTriaxial : Triaxial {
    FoulingOptions fouling = {};
    std::filesystem::path material = {};
    WriteOption written = {};

    void declare_options(auto& option) {
        Triaxial::declare_options(option);
        option(
            "material", material, "",
            "Material card (card.csv of material_card), which gives the friction and the contact "
            "stiffness of the rocks instead of --friction and --clump-stiffness. Empty: none.");
        test.cycles.declare_options(option);
        fouling.declare_options(option);
        option.group("Files");
        written.declare_options(option, write_of_clumps);
    }
};

TriaxialSettings settings_at(const Triaxial& t, double pressure) {
    TriaxialSettings settings = t.test;
    settings.confining_pressure = pressure;
    return settings;
}

/// Stages of a monotonic test.
std::size_t stages_of(const TriaxialSettings& settings) {
    return static_cast<std::size_t>(
        std::llround(settings.final_axial_strain / settings.stage_strain));
}

// settings of one test: of several pressures, only its own
std::vector<NamedValue> settings_of(const Common& common, double pressure) {
    std::vector<NamedValue> settings = common.settings;
    for (NamedValue& entry : settings)
        if (entry.key == "confining_pressure_Pa") entry.value = fmt::format("{:g}", pressure);
    return settings;
}

/// Folder of a test's results within that of the run.
std::filesystem::path folder_in(const Triaxial& t, double pressure) {
    return t.confining_pressure.size() == 1 ? "" : folder_of(pressure);
}

constexpr auto test_file = "triaxial.ckpt.h5";

/// Data that all tests of a run share.
struct Shared {
    const FouledTriaxial& settings;
    const Common& common;
    const TriaxialScene& scene;
    Progress& progress;
    MadeSpecimen specimen; ///< empty if a single test is resumed
};

/// Common settings of one test, whose results go into a folder of their own.
Common common_of(const Common& common, double pressure, const std::filesystem::path& folder) {
    Common own = common;
    own.out = common.out / folder;
    own.settings = settings_of(common, pressure);
    std::filesystem::create_directories(own.out);
    return own;
}

/// One test at one pressure: runs it and writes its results.
class Test {
public:
    Test(const Shared& shared, std::size_t number, const std::filesystem::path& folder,
         unsigned threads)
        : shared_(shared),
          settings_(settings_at(shared.settings, shared.settings.confining_pressure[number])),
          common_(common_of(shared.common, settings_.confining_pressure, folder)),
          simulation_(make_simulation(shared.scene, threads)), test_(simulation_, settings_),
          run_(simulation_, common_, "triaxial",
               progress_slot(shared.progress, static_cast<unsigned>(number))) {}

    /// Begins with the specimen, or resumes from the checkpoint of this test if there is one.
    void begin(const std::filesystem::path& checkpoint);
    void run();
    Report summary() const;
    /// Draws curves or cycles of some tests into a folder.
    static void draw(const std::filesystem::path& folder, const TriaxialSettings& settings,
                     const std::vector<const Test*>& tests);

private:
    const TriaxialState& state() const { return test_.state(); }
    bool advance();
    void write_curves() const;
    void record();
    bool is_last_row() const;
    void add_to_summary_of_cycles(Report& summary) const;
    void finish();
    /// Path of a file of the whole test, or of the part since it was resumed.
    std::filesystem::path file(const std::string& name, const char* extension) const {
        return common_.out / (first_point_ == 0 ? name + extension
                                                : fmt::format("{}_from_stage_{}{}", name,
                                                              first_point_, extension));
    }

    const Shared& shared_;
    TriaxialSettings settings_;
    Common common_;
    Simulation simulation_;
    TriaxialTest test_;
    Run run_;
    std::unique_ptr<FrameWriter> frames_;
    std::vector<View> views_;
    std::size_t first_point_ = 0, recorded_ = 0;
};

void Test::begin(const std::filesystem::path& checkpoint) {
    const FoulingOptions& fouling = shared_.settings.fouling;
    const auto add_fields = [&] {
        if (!fouling.any()) return;
        add_fouling(simulation_.world(), fouling);
        simulation_.prepare();
    };
    if (checkpoint.empty()) { // the specimen is made without fines
        restore_specimen(simulation_, shared_.scene, shared_.specimen.state);
        add_fields();
        if (fouling.any()) fill_with_fines(simulation_.world(), fouling, common_.seed);
    } else {
        add_fields();
        run_.resume(checkpoint);
    }
}

void Test::run() {
    first_point_ = recorded_ = state().curves.size();
    try {
        run_.go({{.advance = [this](Simulation&) { return advance(); },
                  .progress = [this](const World&) { return test_.progress(); }}});
    } catch (...) { // keep the part of the curve that was computed
        if (!state().curves.empty()) write_curves();
        throw;
    }
    finish();
}

bool Test::advance() {
    if (state().phase == TriaxialPhase::done) return false;
    const bool goes_on = test_.advance();
    record();
    return goes_on;
}

void Test::write_curves() const {
    write_stages(common_.out / "curve.csv", state().curves);
    if (settings_.cycles.are_given()) write_cycles(common_.out, state().cyclic);
}

/// Whether the stage that has just ended is the last one.
bool Test::is_last_row() const {
    if (settings_.cycles.are_given()) return state().phase == TriaxialPhase::done;
    return state().stage == stages_of(settings_);
}

void Test::record() {
    const TestCurves& curves = test_.state().curves;
    if (curves.size() <= recorded_) return;
    recorded_ = curves.size();
    const std::size_t stage = curves.size() - 1;
    const World& world = simulation_.world();
    if (stage == 0) write_sensor_drift(common_.out / "sensor_rocks.csv", world);
    if (!frames_)
        frames_ = std::make_unique<FrameWriter>(file("triaxial", ".vtkhdf"), common_.settings,
                                                shared_.settings.written.extras());
    const bool cyclic = settings_.cycles.are_given();
    const bool shown =
        stage == 0 || is_last_row() || (!cyclic && stage == stages_of(settings_) / 2);
    if (!cyclic && stage % shared_.settings.frame_stages != 0 && !shown) return;
    const BodyFrame frame = frame_of_bodies(world);
    frames_->add(world, frame);
    if (!shown) return;
    views_.push_back(view_of_bodies(world, frame, [&](std::size_t index) {
        const auto id = static_cast<EntityId>(frame.ids[index]);
        const auto& sensors = world.resource<Specimen>().smart_rocks;
        const bool sensor = std::find(sensors.begin(), sensors.end(), id) != sensors.end();
        return sensor ? Colour{230, 120, 20} : rock_colour(id);
    }));
    views_.back().caption = fmt::format("{:.1f} %", 100 * curves[quantity::axial_strain].back());
    if (cyclic) views_.back().caption += fmt::format(", {} cycles", state().stage);
}

void Test::finish() {
    write_curves();
    frames_.reset();
    draw(common_.out, settings_, {this});
    if (!views_.empty())
        draw_picture(file("specimen", ".png"), views_, {.azimuth = 0.3, .elevation = 0.15}, 900);
    if (shared_.settings.fouling.any()) {
        const World& world = std::as_const(simulation_).world();
        const FieldSet set = fields_of(world, {});
        write_fields(set, common_.out, "fields", world.resource<Clock>().time(), common_.settings);
        draw_slice(set, {"porosity", "fouling", "saturation", "mean_stress"},
                   common_.out / "fields.png");
    }
    write_results(common_, summary());
}

void Test::draw(const std::filesystem::path& folder, const TriaxialSettings& settings,
                const std::vector<const Test*>& tests) {
    std::vector<LabelledCurves> curves;
    std::vector<LabelledCycles> cycles;
    for (const Test* test : tests) {
        const std::string label = label_of(test->settings_.confining_pressure);
        curves.push_back({label, &test->state().curves});
        cycles.push_back({label, &test->state().cyclic});
    }
    if (settings.cycles.are_given())
        draw_cycles(folder / "cycles.png", cycles);
    else
        draw_curves(folder / "curves.png", curves);
}

void Test::add_to_summary_of_cycles(Report& summary) const {
    const TriaxialState& s = state();
    summary.add(named_values_of(s.cyclic));
    summary.add("relative_energy_error",
                properties_of(s.curves, settings_.confining_pressure).relative_energy_error);
    summary.add("final_axial_strain", s.curves[quantity::axial_strain].back());
    if (!settings_.cycles.are_quasi_static())
        summary.show_sentence("The masses of the cycles are the true ones.");
    if (s.stage < settings_.cycles.count)
        summary.show_sentence(fmt::format("The specimen failed in cycle {} of {}: axial strain "
                                          "{:.3g} % (--largest-axial-strain).",
                                          s.stage + 1, settings_.cycles.count,
                                          100 * s.curves[quantity::axial_strain].back()));
}

Report Test::summary() const {
    const TriaxialState& s = test_.state();
    Report summary;
    summary.add("confining_pressure_Pa", settings_.confining_pressure);
    if (settings_.cycles.are_given())
        add_to_summary_of_cycles(summary);
    else
        summary.add(named_values_of(properties_of(s.curves, settings_.confining_pressure)));
    summary.add("core_porosity", s.core_porosity);
    summary.add("core_porosity_after_preparation", s.prepared_porosity);
    summary.add("core_porosity_as_poured", s.poured_porosity);
    summary.add("trial_consolidations", s.trials);
    summary.add("global_porosity", s.global_porosity);
    summary.add("height_m", s.height);
    summary.add("diameter_m", 2 * shared_.scene.specimen.radius);
    summary.add("diameter_over_largest_rock",
                2 * shared_.scene.specimen.radius / shared_.scene.grading.sieves.front().size);
    summary.add("sensor_rock_drift_m", s.drift);
    summary.add("sensor_rock_rotation_deg", s.rotation * 180 / pi);
    summary.add("coordination_number", s.curves[quantity::coordination_number].back());
    if (const World& world = std::as_const(simulation_).world();
        has_wear(shared_.scene.specimen.law))
        summary.add("contacts_at_yield_share", share_at_yield(world));
    summary.add("stages", s.stage);
    if (shared_.settings.fouling.any())
        add_fouling_results(summary, std::as_const(simulation_).world());
    run_.add_to_summary(summary);
    if (const MadeSpecimen& made = shared_.specimen; made.count.steps > 0) { // not resumed
        summary.add("preparation_steps", made.steps);
        summary.add("preparation_wall_time_s", made.count.wall_time);
    }
    if (settings_.cycles.are_given())
        summary.show({"load_cycles", "final_axial_strain", "permanent_axial_strain",
                      "permanent_volumetric_strain", "axial_strain_in_last_decade",
                      "axial_strain_in_decade_before", "resilient_modulus_Pa",
                      "resilient_poisson_ratio", "damping_ratio"});
    else
        summary.show({"peak_q_Pa", "strain_at_peak", "peak_friction_angle_deg",
                      "mean_q_last_quarter_Pa", "secant_modulus_E50_Pa", "poisson_ratio_E50",
                      "final_volumetric_strain"});
    summary.show({"core_porosity", "diameter_over_largest_rock", "worst_ring_pressure_error"});
    if (!settings_.cycles.are_given()) summary.show({"worst_boundary_contact_stress_mismatch"});
    summary.show({"relative_energy_error", "wall_time_s"});
    return summary;
}

void report_specimen(const Triaxial& t, const TriaxialScene& scene, const Common& common) {
    report_news(common,
                fmt::format("{}specimen: {} rocks, {} of them sensor rocks, diameter {:.1f} mm, "
                            "height about {:.0f} mm, D/d_max {:.2f}",
                            sentence_of(scene.sample,
                                        sieve_back(scene.sample.rocks, scene.clumps, scene.grading,
                                                   scene.sample.truncated_fraction)),
                            t.bodies, scene.poses.size(), 2e3 * scene.specimen.radius,
                            1e3 * scene.specimen.height,
                            2 * scene.specimen.radius / scene.grading.sieves.front().size));
}

/// Makes the specimen of all tests, or resumes from `checkpoint` if it is not empty.
MadeSpecimen make_specimen(const Shared& shared, const std::filesystem::path& checkpoint) {
    Common common = shared.common;
    common.resume = checkpoint;
    const double pressure = shared.settings.confining_pressure.front();
    MadeSpecimen made = bris::make_specimen(shared.scene, settings_at(shared.settings, pressure),
                                            common, progress_slot(shared.progress));
    shared.progress.pause();
    report_news(common, fmt::format("specimen {}: core porosity {:.4f}, {} steps, {:.1f} s",
                                    made.was_kept ? "made before (--beds)" : "prepared",
                                    made.core_porosity, made.steps, made.count.wall_time));
    return made;
}

/// What --resume names: nothing, the checkpoint of a specimen or of one test, or the directory of a
/// run.
struct Resume {
    std::filesystem::path specimen, test, directory;
    Resume(const std::filesystem::path& path, std::size_t tests) {
        if (std::filesystem::is_directory(path)) {
            directory = path;
            if (std::filesystem::exists(path / specimen_file)) specimen = path / specimen_file;
            require(!specimen.empty(), fmt::format("--resume: expected {} in '{}', found none",
                                                   specimen_file, path.string()));
        } else if (path.filename() == specimen_file) {
            specimen = path;
        } else if (!path.empty()) {
            test = path;
            require(tests == 1, fmt::format("--resume: expected one --confining-pressure for the "
                                            "checkpoint of one test, found {}; a run of several "
                                            "tests is resumed from its directory",
                                            tests));
        }
    }
    /// Throws InputError if a checkpoint was made with settings other than those of this run.
    void require_same_settings(const Triaxial& t, const Common& common) const {
        Common of_specimen = common;
        of_specimen.resume = specimen;
        require_same_specimen(of_specimen);
        for (const double pressure : t.confining_pressure)
            if (const auto file = test_in(folder_in(t, pressure)); !file.empty())
                (void)checkpoint_to_resume(file, common.scenario, settings_of(common, pressure));
    }
    /// Checkpoint of the test whose results go into a folder of the run. Empty: the test begins
    /// with the specimen.
    std::filesystem::path test_in(const std::filesystem::path& folder) const {
        if (directory.empty()) return test;
        const auto file = directory / folder / test_file;
        return std::filesystem::exists(file) ? file : std::filesystem::path();
    }
};

void show_card(Report& summary, const FouledTriaxial& t) {
    if (t.material.empty()) return;
    const MaterialCard card = read_material_card(t.material);
    const auto& [friction, stiffness] = std::tie(card.friction, card.clump_stiffness);
    summary.show_sentence(
        fmt::format("The rocks are those of {}: friction {}, contact stiffness {}.",
                    t.material.string(), three_digits(friction.value, friction.low, friction.high),
                    three_digits(stiffness.value, stiffness.low, stiffness.high, "N/m")));
}

void write_all(const Shared& shared, const std::vector<std::unique_ptr<Test>>& done) {
    Report all;
    std::vector<const Test*> tests;
    const auto& pressures = shared.settings.confining_pressure;
    for (std::size_t k = 0; k < done.size(); ++k) {
        all.add_part(done.size() > 1 ? folder_of(pressures[k]) : "", done[k]->summary());
        tests.push_back(done[k].get());
    }
    if (done.size() > 1) Test::draw(shared.common.out, shared.settings.test, tests);
    show_card(all, shared.settings);
    report_results(shared.common, all);
}

/// Takes friction and contact stiffness from the material card, if there is one, and writes them
/// into the settings that go with the results.
FouledTriaxial with_card(FouledTriaxial t, Common& common) {
    if (t.material.empty()) return t;
    const Triaxial unchanged;
    require(t.test.friction == unchanged.test.friction &&
                t.specimen.clump_stiffness == unchanged.specimen.clump_stiffness,
            "--material: expected neither --friction nor --clump-stiffness with a card, which "
            "gives both");
    const MaterialCard card = read_material_card(t.material);
    t.test.friction = card.friction.value;
    t.specimen.clump_stiffness = card.clump_stiffness.value;
    for (NamedValue& setting : common.settings) {
        if (setting.key == "friction") setting.value = t.test.friction;
        if (setting.key == "clump_stiffness_N_per_m") setting.value = t.specimen.clump_stiffness;
    }
    return t;
}

void check_options(const FouledTriaxial& given, const Common& typed) {
    Common common = typed;
    const FouledTriaxial t = with_card(given, common);
    require_memory_for(t,
                       std::min(common.threads, static_cast<unsigned>(t.confining_pressure.size())),
                       common.memory_limit);
    check_test(t);
    check_cycles(t.test.cycles, t.specimen.law, std::ranges::min(t.confining_pressure));
    check_fouling(t.fouling);
    Resume(common.resume, t.confining_pressure.size()).require_same_settings(t, common);
    say_how_read(grading_named(t.grading));
}

void run(const FouledTriaxial& given, const Common& typed) {
    Common common = typed;
    const FouledTriaxial t = with_card(given, common);
    const std::size_t tests = t.confining_pressure.size();
    const Resume from(common.resume, tests);
    const TriaxialScene scene = make_scene(t, common.seed);
    report_specimen(t, scene, common);
    const unsigned at_once =
        std::max(1u, std::min<unsigned>(common.threads, static_cast<unsigned>(tests)));
    const unsigned threads = std::max(1u, common.threads / at_once);
    Progress progress = make_progress(common);
    Shared shared{t, common, scene, progress, {}};
    if (from.test.empty()) shared.specimen = make_specimen(shared, from.specimen);
    if (tests > 1)
        progress.begin_job(
            static_cast<double>(tests) *
            (1 + (t.test.cycles.are_given() ? t.test.cycles.count
                                            : static_cast<double>(stages_of(t.test)))));
    std::vector<std::unique_ptr<Test>> done(tests);
    run_ensemble(tests, at_once, [&](std::size_t k) {
        const std::filesystem::path folder = folder_in(t, t.confining_pressure[k]);
        done[k] = std::make_unique<Test>(shared, k, folder, threads);
        done[k]->begin(from.test_in(folder));
        done[k]->run();
    });
    progress.pause();
    write_all(shared, done);
}

std::string explain(const FouledTriaxial& given, const Common& typed) {
    Common common = typed;
    const FouledTriaxial t = with_card(given, common);
    if (!t.fouling.any()) return explain_triaxial(t, common);
    Simulation simulation = make_simulation(make_scene(t, common.seed), 1);
    add_fouling(simulation.world(), t.fouling);
    simulation.prepare();
    return simulation.schedule().explain();
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::FouledTriaxial>(
        argc, argv,
        {.name = "triaxial",
         .description = "Drained triaxial compression or load cycles of railway ballast in a "
                        "servo-controlled membrane.",
         .divides = true,
         .makes_beds = true},
        bris::check_options, bris::run, bris::explain);
}
