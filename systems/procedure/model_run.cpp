#include "systems/procedure/model_run.hpp"

#include "components/body.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/stopwatch.hpp"
#include "systems/build/scene.hpp"
#include "systems/output/contacts.hpp"
#include "systems/output/record.hpp"
#include "systems/procedure/kept_run.hpp"
#include "systems/procedure/specimen_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <queue>

namespace bris {

namespace {

constexpr std::size_t shells = 5; // sensors, 1, 2, 3, 4 and beyond

std::vector<RockPose> poses_of(World& world, const std::vector<EntityId>& rocks) {
    std::vector<RockPose> poses;
    for (const EntityId id : rocks) poses.push_back({value_of<Position>(world, id), value_of<Orientation>(world, id)});
    return poses;
}

/// Contacts from each rock to the nearest sensor rock.
std::vector<unsigned> shells_of(const World& world, const std::vector<EntityId>& rocks, std::size_t sensors) {
    std::map<EntityId, std::size_t> place;
    for (std::size_t k = 0; k < rocks.size(); ++k) place[rocks[k]] = k;
    std::vector<std::vector<std::size_t>> neighbours(rocks.size());
    for (const TouchingPair& pair : touching_pairs<SpherePairs>(world)) {
        const auto a = place.find(pair.names.owner), b = place.find(pair.names.partner);
        if (a == place.end() || b == place.end()) continue;
        neighbours[a->second].push_back(b->second);
        neighbours[b->second].push_back(a->second);
    }
    std::vector<unsigned> shell(rocks.size(), shells - 1);
    std::queue<std::size_t> next;
    for (std::size_t k = 0; k < sensors; ++k) {
        shell[k] = 0;
        next.push(k);
    }
    for (; !next.empty(); next.pop())
        for (const std::size_t n : neighbours[next.front()])
            if (shell[next.front()] + 1 < shell[n]) {
                shell[n] = shell[next.front()] + 1;
                next.push(n);
            }
    return shell;
}

void disturb(World& world, const std::vector<EntityId>& rocks, double size, std::uint64_t seed) {
    for (const EntityId id : rocks) value_of<Position>(world, id) += size * Random(seed, id).direction();
}

/// Sensors on the first rocks, recorded from where they stand now.
void give_sensors(Simulation& simulation, const ModelArm& arm, const std::vector<RockPose>& start) {
    const Corrections& c = arm.corrections;
    World& world = simulation.world();
    std::vector<std::vector<TimedMeasurement>> samples;
    std::vector<EntityId> hosts;
    for (std::size_t s = 0; s < arm.ways.size(); ++s) {
        if (arm.ways[s].strain.empty()) continue;
        hosts.push_back(world.resource<Specimen>().smart_rocks[s]);
        samples.emplace_back();
        for (std::size_t k = 0; k < arm.ways[s].strain.size(); ++k) {
            TimedMeasurement m{arm.ways[s].strain[k], {}, arm.ways[s].strain[k] + c.lateness};
            m.what.position = start[s].position + arm.ways[s].displacement[k];
            const bool oriented = arm.ways[s].rotation[k].allFinite();
            if (oriented) m.what.attitude = exponential_map(arm.ways[s].rotation[k]) * start[s].orientation;
            else m.what.up = (start[s].orientation.conjugate() * Vec3::UnitZ() - arm.ways[s].tilt[k]).normalized();
            m.what.velocity = m.what.spin = Vec3::Zero(); // at the end of a stage all is at rest
            m.what.velocity_deviation = m.what.spin_deviation = 1e-6;
            m.what.position_deviation = c.position_noise;
            m.what.attitude_deviation = c.attitude_noise;
            samples.back().push_back(m);
        }
    }
    if (hosts.empty()) return;
    add_sensors(world, hosts, std::move(samples), c.filter, c.injection_steps);
    auto& fusion = world.resource<Fusion>();
    fusion.by_strain = true;
    fusion.spread = c.spread;
    fusion.pull = c.pull;
    fusion.largest_shift = c.largest_shift;
    fusion.note_every = c.filter.lag > 0 ? c.note_every : 0;
    simulation.prepare();
}

/// A model in the making: the test it runs, and where its rocks stood when shearing began.
struct Model {
    Simulation simulation;
    TriaxialTest test;
    std::vector<EntityId> rocks;
    std::vector<RockPose> start;
    double work_before = 0;

    Model(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const ModelArm& arm, const RockBelief& belief, std::uint64_t seed)
        : simulation(make_simulation(scene, 1, false)), test(simulation, with_friction(settings, belief.friction)) {
        simulation.restore(specimen);
        World& world = simulation.world();
        const auto& parts = world.resource<Specimen>();
        rocks = parts.smart_rocks;
        rocks.insert(rocks.end(), parts.rocks.begin(), parts.rocks.end());
        believe(scene, belief);
        if (arm.disturbance > 0) disturb(world, rocks, arm.disturbance, seed);
    }
    static TriaxialSettings with_friction(TriaxialSettings settings, double friction) {
        settings.friction = friction;
        return settings;
    }
    void believe(const TriaxialScene& scene, const RockBelief& belief) { set_rocks(simulation.world(), belief.friction, scene.specimen.clump_stiffness * belief.stiffness); }
    std::size_t stages() const { return test.state().points.size(); }
    /// One block of steps of the test. False: it is done.
    bool advance(const ModelArm& arm) {
        if (!test.advance()) return false;
        if (start.empty() && stages() > 0) begin_shear(arm, poses_of(simulation.world(), rocks), test.state().points.back().boundary_work);
        return true;
    }
    void begin_shear(const ModelArm& arm, std::vector<RockPose> poses, double work) {
        start = std::move(poses);
        work_before = work;
        if (!arm.ways.empty()) give_sensors(simulation, arm, start);
    }
    Archive save() const {
        Archive archive = simulation.snapshot();
        archive.put("model/work_before", std::span<const double>(&work_before, 1));
        save_poses(archive, "model/start", start);
        return archive;
    }
    void load(const ModelArm& arm, const Archive& archive) {
        auto poses = load_poses(archive, "model/start");
        if (!poses.empty()) begin_shear(arm, std::move(poses), archive.get<double>("model/work_before").at(0));
        simulation.restore(archive);
    }
};

void count_fusion(World& world, ModelRun& run) {
    run.fusion_work += fusion_work(world);
    for (std::size_t s = 0; s < world.table<Sensors>().size(); ++s) {
        run.accepted += world.column<Sensors, Accepted>()[s];
        run.refused += world.column<Sensors, Refused>()[s];
        run.too_late += world.column<Sensors, TooLate>()[s];
        run.reduced += world.column<Sensors, Reduced>()[s];
        run.withheld += world.column<Sensors, Withheld>()[s];
    }
}

void keep_stage(const Model& model, World& world, ModelRun& run) {
    const auto now = poses_of(world, run.rocks);
    run.points.push_back(model.test.state().points.back());
    run.displacement.emplace_back();
    run.rotation.emplace_back();
    for (std::size_t k = 0; k < now.size(); ++k) {
        run.displacement.back().push_back(now[k].position - model.start[k].position);
        run.rotation.back().push_back(attitude_error(now[k].orientation, model.start[k].orientation));
    }
}

/// What the filters that look back now know of the ways so far, in place of what they knew before.
void keep_smoothed(const World& world, ModelRun& run) {
    if (!world.has_resource<Fusion>()) return;
    const auto host = world.column<Sensors, SensorHost>();
    run.smoothed.resize(run.sensors);
    for (std::size_t s = 0; s < host.size(); ++s) {
        const auto rock = static_cast<std::size_t>(std::ranges::find(run.rocks, host[s]) - run.rocks.begin());
        auto& way = run.smoothed[rock];
        const auto window = world.resource<Fusion>().filters[s].smoothed();
        if (window.empty()) continue;
        std::erase_if(way, [&](const SmoothedPose& p) { return p.time >= window.front().time; });
        way.insert(way.end(), window.begin(), window.end());
    }
}

/// Settings that a specimen depends on.
std::vector<NamedValue> settings_of_specimen(const std::vector<NamedValue>& all) {
    constexpr std::array names{"seed", "bodies", "grading", "porosity", "porosity_tolerance", "initial_porosity", "compaction_friction", "compaction_pressure_Pa", "vibration",
                               "longest_compaction", "sensor_shape", "sensor_poses", "recordings", "servo_per_element", "density_kg_per_m3", "clump_stiffness_N_per_m",
                               "wall_stiffness_N_per_m", "damping", "safety"};
    std::vector<NamedValue> some;
    std::ranges::copy_if(all, std::back_inserter(some), [&](const NamedValue& v) { return std::ranges::count(names, v.key) > 0; });
    return some;
}

} // namespace

Archive make_specimen(const TriaxialScene& scene, const TriaxialSettings& settings, const Common& common, const std::function<void(double, const std::string&)>& watch) {
    constexpr auto file = "specimen.ckpt.h5";
    const auto of_specimen = settings_of_specimen(common.settings);
    Simulation simulation = make_simulation(scene, common.threads, common.serial);
    TriaxialTest test(simulation, settings);
    if (!common.resume.empty())
        (void)resume(simulation, std::filesystem::is_directory(common.resume) ? common.resume / file : common.resume, "specimen", of_specimen);
    CheckpointKeeper keeper({common.out / file, "specimen", of_specimen});
    while (test.state().phase < TriaxialPhase::consolidate) {
        test.advance();
        watch(test.fraction(), "specimen: " + test.description());
        keeper.attend(simulation);
    }
    keeper.save(simulation);
    return simulation.snapshot();
}

namespace {

/// A run of an arm: it can be kept between any two blocks of steps.
class RunOfArm {
public:
    RunOfArm(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const ModelArm& arm, std::uint64_t seed, const ModelWatch& watch, KeptRun* kept)
        : scene_(scene), settings_(settings), specimen_(specimen), arm_(arm), seed_(seed), watch_(watch), kept_(kept) {}

    ModelRun to_the_end() {
        if (!take_up()) model_ = std::make_unique<Model>(scene_, settings_, specimen_, arm_, arm_.rocks, seed_);
        while (!done_ && advance()) {}
        return std::move(run_);
    }

private:
    bool take_up() {
        const auto before = kept_ != nullptr ? kept_->take_up() : std::nullopt;
        if (!before) return false;
        run_ = load_run(*before);
        wall_before_ = run_.wall_time;
        get_fields(*before, "run/progress", std::tie(told_, done_));
        if (done_) return true;
        const RockBelief now = told_ > 0 ? arm_.learned[told_ - 1].rocks : arm_.rocks;
        model_ = std::make_unique<Model>(scene_, settings_, specimen_, arm_, arm_.catch_up ? now : arm_.rocks, seed_);
        model_->believe(scene_, now);
        model_->load(arm_, *before);
        return true;
    }
    void keep() {
        if (kept_ == nullptr) return;
        Archive archive = done_ ? Archive{} : model_->save();
        run_.wall_time = wall_before_ + seconds_since(began_);
        save_run(archive, run_);
        put_fields(archive, "run/progress", std::tie(std::as_const(told_), std::as_const(done_)));
        kept_->keep(archive);
    }
    /// False: the run is over.
    bool advance() {
        if (!model_->advance(arm_)) {
            end();
            return false;
        }
        const bool catches_up = model_->stages() < run_.points.size();
        watch_.progress(model_->test.fraction(), arm_.name + (catches_up ? " catches up: " : ": ") + model_->test.description());
        if (model_->stages() > run_.points.size()) stage();
        if (interrupted()) {
            keep();
            throw Interrupted(fmt::format("interrupted; {}: go on with --resume and the folder of the results", kept_ == nullptr ? "the specimen is kept" : "what was done is kept"));
        }
        if (kept_ != nullptr && kept_->is_due()) keep();
        return true;
    }
    void stage() {
        World& world = model_->simulation.world();
        if (run_.points.empty()) {
            run_.rocks = model_->rocks;
            run_.sensors = world.resource<Specimen>().smart_rocks.size();
            run_.start = model_->start;
            run_.shell = shells_of(world, run_.rocks, run_.sensors);
        }
        keep_stage(*model_, world, run_);
        keep_smoothed(world, run_);
        watch_.stage(world, run_.points.back());
        if (told_ == arm_.learned.size() || run_.points.back().axial_strain < arm_.learned[told_].strain - 0.5 * settings_.stage_strain) return;
        const RockBelief belief = arm_.learned[told_++].rocks;
        if (!arm_.catch_up) {
            model_->believe(scene_, belief);
            model_->test.rescale();
            return;
        }
        run_.steps += world.resource<Clock>().step;
        model_ = std::make_unique<Model>(scene_, settings_, specimen_, arm_, belief, seed_);
    }
    void end() {
        World& world = model_->simulation.world();
        run_.platen_work = run_.points.back().boundary_work - model_->work_before;
        run_.steps += world.resource<Clock>().step;
        if (world.has_resource<Fusion>()) count_fusion(world, run_);
        run_.wall_time = wall_before_ + seconds_since(began_);
        done_ = true;
        keep();
    }

    const TriaxialScene& scene_;
    const TriaxialSettings& settings_;
    const Archive& specimen_;
    const ModelArm& arm_;
    std::uint64_t seed_;
    const ModelWatch& watch_;
    KeptRun* kept_;
    Instant began_ = this_instant();
    double wall_before_ = 0;
    ModelRun run_;
    std::unique_ptr<Model> model_;
    std::size_t told_ = 0; // of what was learned
    bool done_ = false;
};

} // namespace

ModelRun run_model(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const ModelArm& arm, std::uint64_t seed,
                   const ModelWatch& watch, KeptRun* kept) {
    return RunOfArm(scene, settings, specimen, arm, seed, watch, kept).to_the_end();
}

Progress progress_of_models(const Common& common) {
    return Progress(std::max(2u, common.threads), common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
}

ModelWatch watch_on(Progress& progress, std::size_t model, const Common& common) {
    const auto slot = static_cast<unsigned>(model % std::max(2u, common.threads));
    return {.progress = [&progress, slot](double fraction, const std::string& text) { progress.report(slot, fraction, text); }};
}

std::vector<ModelRun> try_models(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const std::vector<ModelArm>& arms,
                                 double strain, const Common& common, Progress& progress) {
    TriaxialSettings test = settings;
    test.final_axial_strain = std::min(strain, test.final_axial_strain);
    std::vector<ModelRun> runs(arms.size());
    run_ensemble(arms.size(), common.threads, [&](std::size_t k) {
        KeptRun kept(common, test, specimen, arms[k]);
        try {
            runs[k] = run_model(scene, test, specimen, arms[k], common.seed, watch_on(progress, k, common), &kept);
        } catch (const SimulationError& error) {
            runs[k].stopped = fmt::format("{} (friction {:.3g}, stiffness {:.3g}): {}", arms[k].name, arms[k].rocks.friction, arms[k].rocks.stiffness, error.what());
        }
    });
    progress.pause();
    return runs;
}

std::vector<ModelRun> run_models(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const std::vector<ModelArm>& arms,
                                 double strain, const Common& common, Progress& progress) {
    auto runs = try_models(scene, settings, specimen, arms, strain, common, progress);
    for (const ModelRun& run : runs)
        if (!run.stopped.empty()) throw SimulationError(run.stopped);
    return runs;
}

} // namespace bris
