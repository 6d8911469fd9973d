// Drained triaxial compression of railway ballast (clumps of 30 spheres) inside a servo membrane of
// 8 rings x 12 elements, after the TRB report: one specimen, tested at each confining pressure.

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/build/clump_library.hpp"
#include "systems/output/picture.hpp"
#include "systems/output/record.hpp"
#include "systems/procedure/triaxial.hpp"
#include "systems/procedure/triaxial_results.hpp"
#include "systems/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>

namespace bris {

struct Triaxial {
    unsigned bodies = 400;
    std::vector<double> confining_pressure{55e3, 110e3, 165e3};
    std::string grading = "arema_4";
    SpecimenSettings specimen;
    TriaxialSettings test;
    double initial_porosity = 0.37;
    unsigned frame_stages = 10;

    void describe(auto& option) {
        option.group("test");
        option("confining_pressure", confining_pressure, "Pa", "one or several, each tested on the same specimen", above(0));
        option("stage_strain", test.stage_strain, "", "axial strain of a stage", within(1e-6, 1e-2));
        option("final_axial_strain", test.final_axial_strain, "", "at which the test ends", within(1e-4, 0.12));
        option("tolerance", test.tolerance, "", "unbalanced force ratio of an equilibrium", within(1e-8, 0.1));
        option("pressure_tolerance", test.pressure_tolerance, "", "of each ring's pressure at stage ends", within(1e-6, 0.1));
        option("gravity", test.gravity, "", "keep weight during the test (a fifth of the lowest pressure)");
        option.group("specimen");
        option("bodies", bodies, "", "rocks, ten sensor rocks included", within(60, 1e6));
        option("grading", grading, "", "a file of assets/gradings",
               {"arema_24", "arema_25", "arema_3", "arema_4a", "arema_4", "arema_5", "arema_57"});
        option("porosity", test.porosity, "", "of the core (0.6 of the radius, middle half of the height)", within(0.2, 0.6));
        option("porosity_tolerance", test.porosity_tolerance, "", "within which a porosity counts as reached", within(1e-4, 0.1));
        option("initial_porosity", initial_porosity, "", "that sets the size of the mould", within(0.2, 0.7));
        option("compaction_friction", test.compaction_friction, "", "between rocks while the specimen is made", at_least(0));
        option("compaction_pressure", test.compaction_pressure, "Pa", "of the platen while the specimen is made", above(0));
        option("vibration", test.vibration, "", "speed of a rock while the specimen is made: of its bounding radius in a step", within(1e-6, 1e-3));
        option("longest_compaction", test.longest_compaction, "", "steps, beyond which the porosity is not reached", at_least(1));
        option("servo_per_element", specimen.per_element, "", "each membrane element on its own, else each ring");
        option.group("material");
        option("density", specimen.density, "kg/m3", "of the rocks", above(0));
        option("friction", test.friction, "", "rock on rock and rock on platen", at_least(0));
        option("clump_stiffness", specimen.clump_stiffness, "N/m", "normal and shear, of one partner", above(0));
        option("wall_stiffness", specimen.wall_stiffness, "N/m", "of platens and membrane", above(0));
        option("damping", test.damping, "", "local damping", within(0, 0.95));
        option.group("numerics");
        option("safety", test.safety, "", "of the stable step in mass scaling", within(0.05, 1));
        option("move_steps", test.move_steps, "", "over which the platen moves in a stage", at_least(1));
        option("frame_stages", frame_stages, "", "stages between frames of the run file", at_least(1));
    }
};

namespace {

constexpr unsigned sensor_rocks = 10;

/// The specimen's parts; the same for every pressure.
struct Scene {
    std::vector<Clump> clumps;
    Clump smart_rock;
    Grading grading;
    RockSample sample;
    SpecimenSettings specimen;
    std::vector<SmartRockPose> poses;
};

Scene make_scene(const Triaxial& t, const Common& common) {
    const std::filesystem::path assets = BRIS_ASSETS;
    Scene s;
    s.clumps = read_clumps(assets / "clumps");
    std::erase_if(s.clumps, [](const Clump& c) { return c.name == "cube"; });
    s.grading = read_grading(assets / "gradings" / (t.grading + ".csv"));
    s.sample = sample_rocks(s.grading, s.clumps, t.bodies - sensor_rocks, common.seed);
    s.specimen = t.specimen;
    s.specimen.seed = common.seed;
    s.specimen.friction = t.test.friction;
    s.smart_rock = scaled(s.clumps.front(), s.specimen.smartrock_size / s.clumps.front().sieve);
    const double solids = s.sample.solid_volume + sensor_rocks * s.smart_rock.volume;
    s.specimen.radius = radius_for(solids, t.initial_porosity, s.specimen.sectors);
    s.specimen.height = 4 * s.specimen.radius;
    s.poses = smart_rock_poses(s.specimen, s.smart_rock.bounding_radius);
    return s;
}

Simulation make_simulation(const Scene& s, unsigned threads, const Common& common) {
    World world = make_triaxial_world(s.specimen, s.clumps, s.smart_rock, s.sample.rocks, s.poses);
    add_lists(world, true);
    world.table<NearSpheres>().add<SlipWork>();
    world.table<NearFacets>().add<SlipWork>();
    world.table<NearPlanes>().add<SlipWork>();
    world.add_resource<TriaxialState>();
    Simulation simulation(std::move(world), steps(LawName::linear, true), threads, {.serial = common.serial, .timed = true});
    simulation.on_restore(forget_lists);
    return simulation;
}

std::string name_of(double pressure) { return fmt::format("{:.4g}kPa", pressure / 1e3); }

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

/// One test at one pressure: runs it and keeps what is to be shown of it.
class Test {
public:
    Test(const Triaxial& t, const Common& common, const Scene& scene, double pressure, std::filesystem::path out,
         std::mutex& files, unsigned threads)
        : common_(common), scene_(scene), settings_(t.test), out_(std::move(out)), files_(files),
          frame_stages_(t.frame_stages), simulation_(make_simulation(scene, threads, common)),
          test_(simulation_, settings_at(t, pressure)),
          keeper_({out_ / "triaxial.ckpt.h5", common.scenario, settings_of(common, pressure)}) {
        settings_.confining_pressure = pressure;
        std::filesystem::create_directories(out_);
    }

    /// Makes the specimen, up to where the pressure begins to matter.
    void prepare(Progress& progress) {
        while (test_.state().phase < TriaxialPhase::consolidate) advance(progress, 0);
    }
    Archive snapshot() const { return simulation_.snapshot(); }
    void restore(const Archive& state) { simulation_.restore(state); }

    void run(Progress& progress, unsigned slot) {
        const auto began = std::chrono::steady_clock::now();
        const std::uint64_t first_step = clock().step;
        while (test_.state().phase != TriaxialPhase::done) {
            advance(progress, slot);
            record();
        }
        wall_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        steps_ = clock().step - first_step;
        finish();
    }

    const TriaxialState& state() const { return test_.state(); }
    std::uint64_t steps_taken() const { return clock().step; }
    Simulation& simulation() { return simulation_; }
    Summary summary() const;

private:
    const Clock& clock() const { return simulation_.world().resource<Clock>(); }

    void advance(Progress& progress, unsigned slot) {
        try {
            test_.advance();
        } catch (const SimulationError& error) {
            const std::lock_guard lock(files_);
            throw SimulationError(fmt::format("{}; state in {}", error.what(), keeper_.save_stopped(simulation_).string()));
        }
        progress.report(slot, test_.fraction(), test_.description());
        const std::lock_guard lock(files_);
        keeper_.attend(simulation_);
    }

    void record();
    void finish();

    const Common& common_;
    const Scene& scene_;
    TriaxialSettings settings_;
    std::filesystem::path out_;
    std::mutex& files_;
    unsigned frame_stages_;
    Simulation simulation_;
    TriaxialTest test_;
    std::unique_ptr<FrameWriter> frames_;
    std::vector<View> views_;
    std::size_t recorded_ = 0; // points
    double wall_ = 0;
    std::uint64_t steps_ = 0;
    CheckpointKeeper keeper_;
};

void Test::record() {
    const auto& points = test_.state().points;
    if (points.size() <= recorded_) return;
    recorded_ = points.size();
    const std::size_t stage = points.size() - 1;
    const auto stages = static_cast<std::size_t>(std::llround(settings_.final_axial_strain / settings_.stage_strain));
    const std::lock_guard lock(files_);
    if (!frames_) {
        const std::string name = common_.resume.empty() ? "triaxial" : fmt::format("triaxial_from_stage_{}", stage);
        frames_ = std::make_unique<FrameWriter>(out_ / (name + ".vtkhdf"), common_.settings);
    }
    const bool shown = stage == 0 || stage == stages / 2 || stage == stages;
    if (stage % frame_stages_ != 0 && !shown) return;
    const World& world = simulation_.world();
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
    const std::lock_guard lock(files_);
    write_curve(out_ / "curve.csv", test_.state().points);
    frames_.reset();
    draw_curves(out_ / "curves.png", {{name_of(settings_.confining_pressure), &test_.state().points}});
    draw_picture(out_ / "specimen.png", views_, {.azimuth = 0.3, .elevation = 0.15}, 900);
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
    summary.add("diameter_m", 2 * scene_.specimen.radius);
    summary.add("diameter_over_largest_rock", 2 * scene_.specimen.radius / scene_.grading.sieves.front().size);
    summary.add("sensor_rock_drift_m", s.drift);
    summary.add("coordination_number", s.points.back().coordination);
    summary.add("stages", s.stage);
    summary.add("steps", steps_);
    summary.add("wall_time_s", wall_);
    summary.add("time_per_step_s", wall_ / static_cast<double>(std::max<std::uint64_t>(1, steps_)));
    summary.add("fingerprint", hexadecimal(fingerprint(simulation_.snapshot())));
    for (const NamedValue& entry : common_.settings)
        if (entry.key != "confining_pressure_Pa") summary.add(entry); // this test's own stands above
    return summary;
}

void print_table(const std::vector<Summary>& results) {
    Summary table;
    for (const Summary& result : results) {
        std::string suffix;
        for (const NamedValue& entry : result.entries()) {
            if (entry.key == "confining_pressure_Pa") suffix = name_of(std::get<double>(entry.value));
            if (entry.key == "stage_strain") break; // settings from here on
            NamedValue named = entry;
            named.key = suffix + " " + entry.key;
            table.add(named);
        }
    }
    table.print("triaxial");
}

void run(const Triaxial& t, const Common& common) {
    const Scene scene = make_scene(t, common);
    if (common.explain) {
        fmt::print("{}", make_simulation(scene, 1, common).schedule().explain());
        return;
    }
    const double stages = t.test.final_axial_strain / t.test.stage_strain;
    require(stages > 0.999 && std::abs(stages - std::round(stages)) < 1e-6 * stages,
            fmt::format("--final-axial-strain: expected a multiple of --stage-strain, found {:g} and {:g}",
                        t.test.final_axial_strain, t.test.stage_strain));
    require(common.resume.empty() || t.confining_pressure.size() == 1,
            "--resume: expected one --confining-pressure, found " + std::to_string(t.confining_pressure.size()));
    fmt::print("{}", describe(scene.sample, sieve_back(scene.sample.rocks, scene.clumps, scene.grading, scene.sample.truncated_fraction)));
    fmt::print("specimen: {} rocks, diameter {:.1f} mm, height about {:.0f} mm, D/d_max {:.2f}\n", t.bodies,
               2e3 * scene.specimen.radius, 1e3 * scene.specimen.height,
               2 * scene.specimen.radius / scene.grading.sieves.front().size);
    const std::size_t tests = t.confining_pressure.size();
    const unsigned at_once = std::max(1u, std::min<unsigned>(common.threads, static_cast<unsigned>(tests)));
    const unsigned threads = std::max(1u, common.threads / at_once);
    Progress progress(static_cast<unsigned>(tests), common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
    std::mutex files;
    Archive prepared;
    if (common.resume.empty()) { // one specimen for all
        Test first(t, common, scene, t.confining_pressure.front(), common.out, files, common.threads);
        const auto began = std::chrono::steady_clock::now();
        first.prepare(progress);
        prepared = first.snapshot();
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began;
        progress.pause();
        fmt::print("specimen prepared: core porosity {:.4f} after {} steps, {:.1f} s\n", first.state().prepared_porosity,
                   first.steps_taken(), wall.count());
    } else {
        Simulation any = make_simulation(scene, 1, common);
        prepared = resume(any, common.resume, common.scenario, settings_of(common, t.confining_pressure.front())).state;
    }
    std::vector<std::unique_ptr<Test>> done(tests);
    run_ensemble(tests, at_once, [&](std::size_t k) {
        const double pressure = t.confining_pressure[k];
        const auto out = tests == 1 ? common.out : common.out / name_of(pressure);
        done[k] = std::make_unique<Test>(t, common, scene, pressure, out, files, threads);
        done[k]->restore(prepared);
        done[k]->run(progress, static_cast<unsigned>(k));
    });
    progress.pause();
    std::vector<Summary> results;
    std::vector<TestCurve> curves;
    for (const auto& test : done) results.push_back(test->summary());
    for (std::size_t k = 0; k < tests; ++k) curves.push_back({name_of(t.confining_pressure[k]), &done[k]->state().points});
    print_table(results);
    if (tests > 1) {
        draw_curves(common.out / "curves.png", curves);
        Summary all;
        for (std::size_t k = 0; k < tests; ++k)
            for (const NamedValue& entry : results[k].entries()) {
                NamedValue named = entry;
                named.key = name_of(t.confining_pressure[k]) + "_" + entry.key;
                if (entry.key == "stage_strain") break; // settings from here on
                all.add(named);
            }
        all.add(common.settings);
        all.write(common.out / "summary.json");
    }
    fmt::print("results in {}\n", common.out.string());
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Triaxial>(argc, argv, "triaxial",
                                              "drained triaxial compression of ballast in a servo membrane", bris::run);
}
