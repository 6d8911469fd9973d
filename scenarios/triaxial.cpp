// Drained triaxial compression of railway ballast (clumps of 30 spheres) inside a servo membrane of
// 8 rings x 12 elements, after the TRB report: one specimen, tested at each confining pressure.

#include "scenarios/triaxial/triaxial.hpp"

#include "engine/checkpoint_keeper.hpp"
#include "engine/clock.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/stopwatch.hpp"
#include "engine/summary.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

namespace bris {

namespace {

TriaxialSettings settings_at(const Triaxial& t, double pressure) {
    TriaxialSettings settings = t.test;
    settings.confining_pressure = pressure;
    return settings;
}

// a test's own settings: of several pressures, the one that it has
std::vector<NamedValue> settings_of(const Common& common, double pressure) {
    std::vector<NamedValue> settings = common.settings;
    for (NamedValue& entry : settings)
        if (entry.key == "confining_pressure_Pa") entry.value = fmt::format("{:g}", pressure);
    return settings;
}

constexpr auto specimen_file = "specimen.ckpt.h5", test_file = "triaxial.ckpt.h5";

/// Settings that do not matter yet while a specimen is made: one specimen serves for many tests.
const std::initializer_list<std::string_view> of_the_test_alone{"confining_pressure_Pa",
                                                                "stage_strain",
                                                                "final_axial_strain",
                                                                "tolerance",
                                                                "pressure_tolerance",
                                                                "friction",
                                                                "gravity",
                                                                "move_steps",
                                                                "mass_scaling",
                                                                "frame_stages"};

/// What the tests of a run share.
struct Shared {
    const Triaxial& settings;
    const Common& common;
    const TriaxialScene& scene;
    Progress& progress;
    std::mutex files;            ///< HDF5 and gnuplot: one at a time
    double preparation_wall = 0; ///< s
    std::uint64_t preparation_steps = 0;
};

/// One test at one pressure: runs it and keeps what is to be shown of it.
class Test {
public:
    Test(Shared& shared, double pressure, std::filesystem::path out, unsigned threads,
         const char* checkpoint = test_file)
        : shared_(shared), settings_(settings_at(shared.settings, pressure)), out_(std::move(out)),
          simulation_(make_simulation(shared.scene, threads, shared.common.serial)),
          test_(simulation_, settings_), keeper_({out_ / checkpoint, shared.common.scenario,
                                                  settings_of(shared.common, pressure)}) {
        std::filesystem::create_directories(out_);
    }

    /// Goes on from a state, or from a checkpoint of this test (`may_differ`: settings that did not
    /// matter yet).
    void restore(const Archive& state) { simulation_.restore(state); }
    void resume_from(const std::filesystem::path& file,
                     std::initializer_list<std::string_view> may_differ = {}) {
        resume(simulation_, file, shared_.common.scenario,
               settings_of(shared_.common, settings_.confining_pressure), may_differ);
    }

    /// Makes the specimen, up to where the pressure begins to matter.
    Archive prepare() {
        const auto began = this_instant();
        while (test_.state().phase < TriaxialPhase::consolidate) advance(0);
        shared_.preparation_wall = seconds_since(began);
        shared_.preparation_steps = clock().step;
        keeper_.save(simulation_);
        shared_.progress.pause();
        fmt::print("specimen prepared: core porosity {:.4f}, {} steps, {:.1f} s\n",
                   test_.state().prepared_porosity, shared_.preparation_steps,
                   shared_.preparation_wall);
        return simulation_.snapshot();
    }

    void run(unsigned slot) {
        const auto began = this_instant();
        const std::uint64_t first_step = clock().step;
        first_point_ = recorded_ = test_.state().points.size();
        try {
            while (test_.state().phase != TriaxialPhase::done) {
                advance(slot);
                record();
            }
        } catch (...) { // what there is of the curve is not lost
            const std::lock_guard lock(shared_.files);
            if (!test_.state().points.empty())
                write_curve(out_ / "curve.csv", test_.state().points);
            throw;
        }
        wall_ = seconds_since(began);
        steps_ = clock().step - first_step;
        finish();
    }

    const TriaxialState& state() const { return test_.state(); }
    Simulation& simulation() { return simulation_; }
    Summary summary() const;

private:
    const Clock& clock() const { return simulation_.world().resource<Clock>(); }

    void advance(unsigned slot) {
        try {
            test_.advance();
        } catch (const SimulationError& error) {
            const std::lock_guard lock(shared_.files);
            throw SimulationError(fmt::format("{}; state in {}", error.what(),
                                              keeper_.save_stopped(simulation_).string()));
        }
        shared_.progress.report(slot, test_.fraction(), test_.description());
        const std::lock_guard lock(shared_.files);
        keeper_.attend(simulation_);
    }

    void record();
    void finish();
    /// A file of the whole test, or of the part since it was resumed.
    std::filesystem::path file(const std::string& name, const char* extension) const {
        return out_ / (first_point_ == 0
                           ? name + extension
                           : fmt::format("{}_from_stage_{}{}", name, first_point_, extension));
    }

    Shared& shared_;
    TriaxialSettings settings_;
    std::filesystem::path out_;
    Simulation simulation_;
    TriaxialTest test_;
    std::unique_ptr<FrameWriter> frames_;
    std::vector<View> views_;
    std::size_t first_point_ = 0, recorded_ = 0;
    double wall_ = 0;
    std::uint64_t steps_ = 0;
    CheckpointKeeper keeper_;
};

void Test::record() {
    const auto& points = test_.state().points;
    if (points.size() <= recorded_) return;
    recorded_ = points.size();
    const std::size_t stage = points.size() - 1;
    const auto stages = static_cast<std::size_t>(
        std::llround(settings_.final_axial_strain / settings_.stage_strain));
    const World& world = simulation_.world();
    const std::lock_guard lock(shared_.files);
    if (stage == 0) write_sensor_drift(out_ / "sensor_rocks.csv", world);
    if (!frames_)
        frames_ = std::make_unique<FrameWriter>(
            file("triaxial", ".vtkhdf"), settings_of(shared_.common, settings_.confining_pressure));
    const bool shown = stage == 0 || stage == stages / 2 || stage == stages;
    if (stage % shared_.settings.frame_stages != 0 && !shown) return;
    const BodyFrame frame = frame_of_bodies(world);
    frames_->add(frame);
    if (!shown) return;
    views_.push_back(view_of_bodies(world, frame, [&](std::size_t place) {
        const auto id = static_cast<EntityId>(frame.ids[place]);
        const auto& sensors = world.resource<Specimen>().smart_rocks;
        const bool sensor = std::find(sensors.begin(), sensors.end(), id) != sensors.end();
        return sensor ? Colour{230, 120, 20} : stone_colour(id);
    }));
    views_.back().caption = fmt::format("{:.1f} %", 100 * points.back().axial_strain);
}

void Test::finish() {
    const std::lock_guard lock(shared_.files);
    keeper_.save(simulation_);
    write_curve(out_ / "curve.csv", test_.state().points);
    frames_.reset();
    draw_curves(out_ / "curves.png",
                {{folder_of(settings_.confining_pressure), &test_.state().points}});
    if (!views_.empty())
        draw_picture(file("specimen", ".png"), views_, {.azimuth = 0.3, .elevation = 0.15}, 900);
    summary().write(out_ / "summary.json");
}

Summary Test::summary() const {
    const TriaxialState& s = test_.state();
    Summary summary;
    summary.add("confining_pressure_Pa", settings_.confining_pressure);
    summary.add(describe(properties_of(s.points, settings_.confining_pressure)));
    summary.add("core_porosity", s.core_porosity);
    summary.add("core_porosity_after_compaction", s.prepared_porosity);
    summary.add("global_porosity", s.global_porosity);
    summary.add("height_m", s.height);
    summary.add("diameter_m", 2 * shared_.scene.specimen.radius);
    summary.add("diameter_over_largest_rock",
                2 * shared_.scene.specimen.radius / shared_.scene.grading.sieves.front().size);
    summary.add("sensor_rock_drift_m", s.drift);
    summary.add("sensor_rock_turn_deg", s.turn * 180 / pi);
    summary.add("coordination_number", s.points.back().coordination);
    summary.add("stages", s.stage);
    summary.add("steps", steps_);
    summary.add("wall_time_s", wall_);
    summary.add("time_per_step_s", wall_ / static_cast<double>(std::max<std::uint64_t>(1, steps_)));
    if (shared_.preparation_steps > 0) { // made in this run
        summary.add("preparation_steps", shared_.preparation_steps);
        summary.add("preparation_wall_time_s", shared_.preparation_wall);
    }
    summary.add("fingerprint", hexadecimal(fingerprint(simulation_.snapshot())));
    for (const NamedValue& entry : shared_.common.settings)
        if (entry.key != "confining_pressure_Pa")
            summary.add(entry); // this test's own stands above
    return summary;
}

void print_table(const std::vector<Summary>& results) {
    Summary table;
    for (const Summary& result : results) {
        std::string suffix;
        for (const NamedValue& entry : result.entries()) {
            if (entry.key == "confining_pressure_Pa")
                suffix = folder_of(std::get<double>(entry.value));
            if (entry.key == "stage_strain") break; // settings from here on
            NamedValue named = entry;
            named.key = suffix + " " + entry.key;
            table.add(named);
        }
    }
    table.print("triaxial");
}

void print_specimen(const Triaxial& t, const TriaxialScene& scene) {
    fmt::print("{}",
               describe(scene.sample, sieve_back(scene.sample.rocks, scene.clumps, scene.grading,
                                                 scene.sample.truncated_fraction)));
    fmt::print("specimen: {} rocks, {} of them sensor rocks, diameter {:.1f} mm, height about "
               "{:.0f} mm, D/d_max {:.2f}\n",
               t.bodies, scene.poses.size(), 2e3 * scene.specimen.radius,
               1e3 * scene.specimen.height,
               2 * scene.specimen.radius / scene.grading.sieves.front().size);
}

/// The specimen of all tests: made now, or as far as `checkpoint` has it, from there.
Archive make_specimen(Shared& shared, const std::filesystem::path& checkpoint) {
    Test first(shared, shared.settings.confining_pressure.front(), shared.common.out,
               shared.common.threads, specimen_file);
    if (!checkpoint.empty()) first.resume_from(checkpoint, of_the_test_alone);
    return first.prepare();
}

/// What --resume names: nothing, a specimen, one test, or the directory of a run.
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
            require(tests == 1, fmt::format("--resume: expected one --confining-pressure for one "
                                            "test's checkpoint, found {}; "
                                            "a run of several goes on from its directory",
                                            tests));
        }
    }
    /// The checkpoint of the test whose results go into a folder of the run; empty: begins with the
    /// specimen.
    std::filesystem::path test_in(const std::filesystem::path& folder) const {
        if (directory.empty()) return test;
        const auto file = directory / folder / test_file;
        return std::filesystem::exists(file) ? file : std::filesystem::path();
    }
};

void write_all(const Shared& shared, const std::vector<std::unique_ptr<Test>>& done) {
    std::vector<Summary> results;
    std::vector<TestCurve> curves;
    const auto& pressures = shared.settings.confining_pressure;
    for (std::size_t k = 0; k < done.size(); ++k) {
        results.push_back(done[k]->summary());
        curves.push_back({folder_of(pressures[k]), &done[k]->state().points});
    }
    print_table(results);
    if (done.size() == 1) return;
    draw_curves(shared.common.out / "curves.png", curves);
    Summary all;
    for (std::size_t k = 0; k < done.size(); ++k)
        for (const NamedValue& entry : results[k].entries()) {
            if (entry.key == "stage_strain") break; // settings from here on
            NamedValue named = entry;
            named.key = folder_of(pressures[k]) + "_" + entry.key;
            all.add(named);
        }
    all.add(shared.common.settings);
    all.write(shared.common.out / "summary.json");
}

void run(const Triaxial& t, const Common& common) {
    require_memory_for(t,
                       std::min(common.threads, static_cast<unsigned>(t.confining_pressure.size())),
                       common.memory_limit);
    const TriaxialScene scene = make_scene(t, common.seed);
    if (common.explain) {
        fmt::print("{}", make_simulation(scene, 1, common.serial).schedule().explain());
        return;
    }
    check_test(t);
    print_specimen(t, scene);
    const std::size_t tests = t.confining_pressure.size();
    const unsigned at_once =
        std::max(1u, std::min<unsigned>(common.threads, static_cast<unsigned>(tests)));
    const unsigned threads = std::max(1u, common.threads / at_once);
    Progress progress(static_cast<unsigned>(tests),
                      common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
    Shared shared{t, common, scene, progress, {}};
    const Resume from(common.resume, tests);
    const Archive specimen = from.test.empty() ? make_specimen(shared, from.specimen) : Archive{};
    std::vector<std::unique_ptr<Test>> done(tests);
    run_ensemble(tests, at_once, [&](std::size_t k) {
        const double pressure = t.confining_pressure[k];
        const std::filesystem::path folder = tests == 1 ? "" : folder_of(pressure);
        done[k] = std::make_unique<Test>(shared, pressure, common.out / folder, threads);
        const auto checkpoint = from.test_in(folder);
        if (checkpoint.empty())
            done[k]->restore(specimen);
        else
            done[k]->resume_from(checkpoint);
        done[k]->run(static_cast<unsigned>(k));
    });
    progress.pause();
    write_all(shared, done);
    fmt::print("results in {}\n", common.out.string());
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Triaxial>(
        argc, argv, "triaxial", "drained triaxial compression of ballast in a servo membrane",
        bris::run);
}
