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
#include "systems/procedure/specimen_state.hpp"

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
            TimedMeasurement m{arm.ways[s].strain[k], {}};
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
        set_rocks(world, belief.friction, scene.specimen.clump_stiffness * belief.stiffness);
        if (arm.disturbance > 0) disturb(world, rocks, arm.disturbance, seed);
    }
    static TriaxialSettings with_friction(TriaxialSettings settings, double friction) {
        settings.friction = friction;
        return settings;
    }
    /// The next stage, or with the first call the start of shearing. False: the test is done.
    bool next_stage(const ModelArm& arm, const ModelWatch& watch, const std::string& what) {
        const std::size_t seen = test.state().points.size();
        while (test.state().points.size() == seen) {
            if (!test.advance()) return false;
            watch.progress(test.fraction(), what + test.description());
            if (interrupted()) throw Interrupted("interrupted; the specimen is kept: go on with --resume and the folder of the results");
        }
        if (!start.empty()) return true;
        start = poses_of(simulation.world(), rocks);
        work_before = test.state().points.back().boundary_work;
        if (!arm.ways.empty()) give_sensors(simulation, arm, start);
        return true;
    }
};

void count_fusion(World& world, ModelRun& run) {
    run.fusion_work += fusion_work(world);
    for (std::size_t s = 0; s < world.table<Sensors>().size(); ++s) {
        run.accepted += world.column<Sensors, Accepted>()[s];
        run.refused += world.column<Sensors, Refused>()[s];
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

ModelRun run_model(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const ModelArm& arm, std::uint64_t seed,
                   const ModelWatch& watch) {
    const auto began = this_instant();
    ModelRun run;
    auto model = std::make_unique<Model>(scene, settings, specimen, arm, arm.rocks, seed);
    run.rocks = model->rocks;
    run.sensors = model->simulation.world().resource<Specimen>().smart_rocks.size();
    auto next = arm.learned.begin();
    while (model->next_stage(arm, watch, arm.name + ": ")) {
        World& world = model->simulation.world();
        if (run.points.empty()) {
            run.start = model->start;
            run.shell = shells_of(world, run.rocks, run.sensors);
        }
        keep_stage(*model, world, run);
        watch.stage(world, run.points.back());
        if (next == arm.learned.end() || run.points.back().axial_strain < next->strain - 0.5 * settings.stage_strain) continue;
        const RockBelief belief = (next++)->rocks;
        if (!arm.catch_up) {
            set_rocks(world, belief.friction, scene.specimen.clump_stiffness * belief.stiffness);
            model->test.rescale();
            continue;
        }
        run.steps += world.resource<Clock>().step;
        model = std::make_unique<Model>(scene, settings, specimen, arm, belief, seed);
        while (model->test.state().points.size() < run.points.size()) model->next_stage(arm, watch, arm.name + " catches up: ");
    }
    World& world = model->simulation.world();
    run.platen_work = run.points.back().boundary_work - model->work_before;
    run.steps += world.resource<Clock>().step;
    if (world.has_resource<Fusion>()) count_fusion(world, run);
    run.wall_time = seconds_since(began);
    return run;
}

Progress progress_of_models(const Common& common) {
    return Progress(std::max(2u, common.threads), common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
}

ModelWatch watch_on(Progress& progress, std::size_t model, const Common& common) {
    const auto slot = static_cast<unsigned>(model % std::max(2u, common.threads));
    return {.progress = [&progress, slot](double fraction, const std::string& text) { progress.report(slot, fraction, text); }};
}

std::vector<ModelRun> run_models(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const std::vector<ModelArm>& arms,
                                 double strain, const Common& common, Progress& progress) {
    TriaxialSettings test = settings;
    test.final_axial_strain = std::min(strain, test.final_axial_strain);
    std::vector<ModelRun> runs(arms.size());
    run_ensemble(arms.size(), common.threads, [&](std::size_t k) { runs[k] = run_model(scene, test, specimen, arms[k], common.seed, watch_on(progress, k, common)); });
    progress.pause();
    return runs;
}

} // namespace bris
