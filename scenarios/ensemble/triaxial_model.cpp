#include "scenarios/ensemble/triaxial_model.hpp"

#include "components/body.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "systems/output/contacts.hpp"

#include <map>
#include <queue>
#include <utility>

namespace bris {

namespace {

/// Adds the sensors of a variant to the first rocks, with trajectories relative to the poses
/// `start`.
void give_sensors(Simulation& simulation, const ModelVariant& variant,
                  const std::vector<RockPose>& start) {
    const Corrections& c = variant.corrections;
    World& world = simulation.world();
    std::vector<std::vector<TimedMeasurement>> samples;
    std::vector<EntityId> hosts;
    for (std::size_t s = 0; s < variant.trajectories.size(); ++s) {
        if (variant.trajectories[s].strain.empty()) continue;
        hosts.push_back(world.resource<Specimen>().smart_rocks[s]);
        samples.emplace_back();
        for (std::size_t k = 0; k < variant.trajectories[s].strain.size(); ++k) {
            TimedMeasurement m{variant.trajectories[s].strain[k], {}};
            m.what.position = start[s].position + variant.trajectories[s].displacement[k];
            const bool oriented = variant.trajectories[s].rotation[k].allFinite();
            if (oriented)
                m.what.attitude =
                    exponential_map(variant.trajectories[s].rotation[k]) * start[s].orientation;
            else
                m.what.up = (start[s].orientation.conjugate() * Vec3::UnitZ() -
                             variant.trajectories[s].tilt[k])
                                .normalized();
            // at the end of a stage all rocks are at rest
            m.what.velocity = m.what.angular_velocity = Vec3::Zero();
            m.what.velocity_deviation = m.what.angular_velocity_deviation = 1e-6;
            m.what.position_deviation = c.position_noise;
            m.what.attitude_deviation = c.attitude_noise;
            samples.back().push_back(m);
        }
    }
    if (hosts.empty()) return;
    add_sensors(world, hosts, std::move(samples), c.filter, c.injection_steps);
    auto& fusion = world.resource<Fusion>();
    fusion.by_strain = true;
    fusion.nudging = c.nudging;
    fusion.largest_shift = c.largest_shift;
    simulation.prepare();
}

TriaxialSettings with_friction(TriaxialSettings settings, double friction) {
    settings.friction = friction;
    return settings;
}

/// Neighbours of each of `rocks` in the contact network, as indices into `rocks`.
std::vector<std::vector<std::size_t>> neighbours_of(const World& world,
                                                    const std::vector<EntityId>& rocks) {
    std::map<EntityId, std::size_t> index_of;
    for (std::size_t k = 0; k < rocks.size(); ++k) index_of[rocks[k]] = k;
    std::vector<std::vector<std::size_t>> neighbours(rocks.size());
    for (const TouchingPair& pair : touching_pairs<SpherePairs>(world)) {
        const auto a = index_of.find(pair.names.owner), b = index_of.find(pair.names.partner);
        if (a == index_of.end() || b == index_of.end()) continue;
        neighbours[a->second].push_back(b->second);
        neighbours[b->second].push_back(a->second);
    }
    return neighbours;
}

} // namespace

TriaxialModel::TriaxialModel(const TriaxialScene& scene, const TriaxialSettings& settings,
                             const Archive& specimen, const RockParameters& parameters)
    : simulation_(make_simulation(scene, 1)),
      test_(simulation_, with_friction(settings, parameters.friction)) {
    restore_specimen(simulation_, scene, specimen);
    const auto& parts = world().resource<Specimen>();
    rocks_ = parts.smart_rocks;
    sensors_ = rocks_.size();
    rocks_.insert(rocks_.end(), parts.rocks.begin(), parts.rocks.end());
    set_rocks(world(), parameters.friction, scene.specimen.clump_stiffness * parameters.stiffness);
}

bool TriaxialModel::advance(const ModelVariant& variant) {
    if (!test_.advance()) return false;
    if (start_.empty() && stages() > 0)
        begin_shear(variant, poses(), test_.state().curves[quantity::boundary_work].back());
    return true;
}

void TriaxialModel::begin_shear(const ModelVariant& variant, std::vector<RockPose> poses,
                                double work) {
    start_ = std::move(poses);
    work_before_ = work;
    if (!variant.trajectories.empty()) give_sensors(simulation_, variant, start_);
}

std::vector<RockPose> TriaxialModel::poses() {
    std::vector<RockPose> poses;
    for (const EntityId id : rocks_)
        poses.push_back({value_of<Position>(world(), id), value_of<Orientation>(world(), id)});
    return poses;
}

std::vector<unsigned> TriaxialModel::shells() const {
    const auto neighbours = neighbours_of(simulation_.world(), rocks_);
    std::vector<unsigned> shell(rocks_.size(), farthest_shell);
    std::queue<std::size_t> next;
    for (std::size_t k = 0; k < sensors_; ++k) {
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

Archive TriaxialModel::save() const {
    Archive archive = simulation_.snapshot();
    archive.put("model/work_before", std::span<const double>(&work_before_, 1));
    save_poses(archive, "model/start", start_);
    return archive;
}

void TriaxialModel::load(const ModelVariant& variant, const Archive& archive) {
    auto poses = load_poses(archive, "model/start");
    if (!poses.empty())
        begin_shear(variant, std::move(poses), archive.get<double>("model/work_before").at(0));
    simulation_.restore(archive);
}

} // namespace bris
