#include "systems/procedure/twin.hpp"

#include "components/body.hpp"
#include "components/material.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/stopwatch.hpp"
#include "systems/build/scene.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/output/contacts.hpp"

#include <algorithm>
#include <map>
#include <queue>

namespace bris {

namespace {

constexpr std::size_t shells = 5; // sensors, 1, 2, 3, 4 and beyond

struct RockPose {
    Vec3 position;
    Quat orientation;
};

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

void soften(World& world, double factor) {
    auto& materials = world.resource<Materials>();
    Material& rock = materials.list[world.resource<Specimen>().rock_material];
    rock.normal_stiffness *= factor;
    rock.shear_stiffness *= factor;
    materials.mix();
}

/// Sensors on the first rocks, which record what the truth did, from where they stand now.
void give_sensors(Simulation& simulation, const TwinArm& arm, const TwinRun& truth, const std::vector<RockPose>& start, std::uint64_t seed) {
    std::vector<std::vector<TimedMeasurement>> samples(truth.sensors);
    std::vector<EntityId> hosts;
    for (std::size_t s = 0; s < truth.sensors; ++s) {
        hosts.push_back(truth.rocks[s]);
        Random random(seed, 1000 + s);
        double last = 0;
        for (std::size_t stage = 1; stage < truth.points.size(); ++stage) {
            const double strain = truth.points[stage].axial_strain;
            if (strain - last < 0.999 * arm.interval) continue;
            last = strain;
            TimedMeasurement m{strain, {}};
            const auto noise = [&](double deviation) { return Vec3(deviation * Vec3(random.normal(), random.normal(), random.normal())); };
            m.what.position = start[s].position + truth.displacement[stage][s] + noise(arm.position_noise);
            m.what.attitude = exponential_map(noise(arm.attitude_noise)) * exponential_map(truth.rotation[stage][s]) * start[s].orientation;
            m.what.velocity = m.what.spin = Vec3::Zero(); // at the end of a stage all is at rest
            m.what.velocity_deviation = m.what.spin_deviation = 1e-6;
            m.what.position_deviation = arm.position_noise;
            m.what.attitude_deviation = arm.attitude_noise;
            samples[s].push_back(m);
        }
    }
    World& world = simulation.world();
    add_sensors(world, hosts, std::move(samples), arm.filter, arm.injection_steps);
    world.resource<Fusion>().by_strain = true;
    world.resource<Fusion>().spread = arm.spread;
    world.resource<Fusion>().pull = arm.pull;
    simulation.prepare();
}

double root_mean(double squares, double count) { return count > 0 ? std::sqrt(squares / count) : 0; }

} // namespace

TwinRun run_arm(const TriaxialScene& scene, const TriaxialSettings& given, const Archive& specimen, const TwinArm& arm, const TwinRun* truth,
                std::uint64_t seed, const std::function<void(double, const std::string&)>& watch) {
    require(!arm.fused || truth != nullptr, "twin: expected a true run to record");
    const auto began = this_instant();
    TriaxialSettings settings = given;
    settings.friction = arm.friction;
    Simulation simulation = make_simulation(scene, 1, false);
    simulation.restore(specimen);
    World& world = simulation.world();
    soften(world, arm.stiffness);
    TriaxialTest test(simulation, settings);
    TwinRun run;
    const auto& parts = world.resource<Specimen>();
    run.rocks = parts.smart_rocks;
    run.sensors = run.rocks.size();
    run.rocks.insert(run.rocks.end(), parts.rocks.begin(), parts.rocks.end());
    if (arm.disturbance > 0) disturb(world, run.rocks, arm.disturbance, seed);
    std::vector<RockPose> start;
    double work_before = 0;
    bool more = true;
    while (more) {
        more = test.advance();
        watch(test.fraction(), test.description());
        const auto& points = test.state().points;
        if (points.size() <= run.displacement.size()) continue;
        const auto now = poses_of(world, run.rocks);
        if (start.empty()) {
            start = now;
            run.shell = shells_of(world, run.rocks, run.sensors);
            work_before = points.back().boundary_work;
            if (arm.fused) give_sensors(simulation, arm, *truth, start, seed);
        }
        run.displacement.emplace_back();
        run.rotation.emplace_back();
        for (std::size_t k = 0; k < now.size(); ++k) {
            run.displacement.back().push_back(now[k].position - start[k].position);
            run.rotation.back().push_back(attitude_error(now[k].orientation, start[k].orientation));
        }
    }
    run.points = test.state().points;
    run.platen_work = run.points.back().boundary_work - work_before;
    run.steps = world.resource<Clock>().step;
    if (arm.fused) {
        run.fusion_work = fusion_work(world);
        for (std::size_t s = 0; s < run.sensors; ++s) {
            run.accepted += world.column<Sensors, Accepted>()[s];
            run.refused += world.column<Sensors, Refused>()[s];
        }
    }
    run.wall_time = seconds_since(began);
    return run;
}

TwinErrors errors_of(const TwinRun& run, const TwinRun& truth) {
    TwinErrors e;
    const std::size_t stages = std::min(run.points.size(), truth.points.size());
    double q = 0, volume = 0, ring = 0, rings = 0;
    std::vector<double> displacement(shells), rotation(shells), count(shells);
    for (std::size_t k = 1; k < stages; ++k) {
        const TriaxialPoint &a = run.points[k], &b = truth.points[k];
        q += std::pow(a.deviatoric_stress - b.deviatoric_stress, 2);
        volume += std::pow(a.volumetric_strain - b.volumetric_strain, 2);
        for (std::size_t r = 0; r < a.ring_radius.size(); ++r, ++rings)
            ring += std::pow((a.ring_radius[r] - run.points[0].ring_radius[r]) - (b.ring_radius[r] - truth.points[0].ring_radius[r]), 2);
        for (std::size_t rock = 0; rock < truth.rocks.size(); ++rock) {
            const std::size_t s = truth.shell[rock];
            displacement[s] += (run.displacement[k][rock] - truth.displacement[k][rock]).squaredNorm();
            rotation[s] += attitude_error(exponential_map(run.rotation[k][rock]), exponential_map(truth.rotation[k][rock])).squaredNorm();
            ++count[s];
        }
    }
    const auto n = static_cast<double>(stages - 1);
    e.q = root_mean(q, n);
    e.volumetric_strain = root_mean(volume, n);
    e.ring_radius = root_mean(ring, rings);
    for (std::size_t s = 0; s < shells; ++s) {
        e.displacement.push_back(root_mean(displacement[s], count[s]));
        e.rotation.push_back(root_mean(rotation[s], count[s]));
    }
    return e;
}

} // namespace bris
