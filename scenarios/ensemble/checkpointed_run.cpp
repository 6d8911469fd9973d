#include "scenarios/ensemble/checkpointed_run.hpp"

#include "engine/io/checkpoint.hpp"

#include <fmt/format.h>

#include <span>

namespace bris {

namespace {

constexpr auto folder = "runs";

void put(Archive& archive, const std::string& path, const std::vector<double>& numbers) {
    archive.put(path, std::span<const double>(numbers));
}

void put_stages(Archive& archive, const std::string& path,
                const std::vector<std::vector<Vec3>>& stages) {
    std::vector<double> numbers;
    for (const auto& stage : stages)
        for (const Vec3& v : stage) numbers.insert(numbers.end(), v.begin(), v.end());
    put(archive, path, numbers);
}

std::vector<std::vector<Vec3>> get_stages(const Archive& archive, const std::string& path,
                                          std::size_t stages) {
    const auto numbers = archive.get<double>(path);
    std::vector<std::vector<Vec3>> all(stages);
    const std::size_t each = stages > 0 ? numbers.size() / 3 / stages : 0;
    auto next = numbers.begin();
    for (auto& stage : all)
        for (std::size_t k = 0; k < each; ++k, next += 3)
            stage.emplace_back(next[0], next[1], next[2]);
    return all;
}

/// All numbers on which a run depends, except those of the specimen.
void put_variant(Archive& archive, const TriaxialSettings& s, const ModelVariant& variant) {
    const Corrections& c = variant.corrections;
    std::vector<double> numbers{s.confining_pressure,
                                s.stage_strain,
                                s.final_axial_strain,
                                s.friction,
                                s.tolerance,
                                s.pressure_tolerance,
                                s.damping,
                                double(s.move_steps),
                                double(s.longest_stage),
                                s.safety,
                                double(s.mass_scaling),
                                double(s.gravity),
                                variant.rocks.friction,
                                variant.rocks.stiffness,
                                double(static_cast<int>(c.filter.kind)),
                                c.filter.position,
                                c.filter.velocity,
                                c.filter.attitude,
                                c.filter.angular_velocity,
                                c.filter.acceleration_density,
                                c.filter.angular_acceleration_density,
                                c.filter.drift,
                                c.filter.turning,
                                c.filter.gate,
                                double(c.injection_steps),
                                c.nudging.stiffness,
                                c.nudging.largest_force,
                                c.nudging.arm,
                                c.position_noise,
                                c.attitude_noise,
                                c.largest_shift};
    for (const LearnedParameters& b : variant.learned)
        numbers.insert(numbers.end(), {b.strain, b.rocks.friction, b.rocks.stiffness});
    put(archive, "variant", numbers);
    for (const SensorTrajectory& trajectory : variant.trajectories) {
        put(archive, "strain", trajectory.strain);
        put_stages(archive, "trajectory",
                   {trajectory.displacement, trajectory.rotation, trajectory.tilt});
    }
}

auto numbers_of(auto& run) {
    return std::tie(run.sensors, run.fusion_work, run.boundary_work, run.accepted, run.refused,
                    run.steps, run.wall_time, run.reduced, run.withheld, run.core_porosity);
}

} // namespace

void save_poses(Archive& archive, const std::string& path, const std::vector<RockPose>& poses) {
    std::vector<double> numbers;
    for (const RockPose& p : poses) {
        numbers.insert(numbers.end(), p.position.begin(), p.position.end());
        numbers.insert(numbers.end(), {p.orientation.w(), p.orientation.x(), p.orientation.y(),
                                       p.orientation.z()});
    }
    put(archive, path, numbers);
}

std::vector<RockPose> load_poses(const Archive& archive, const std::string& path) {
    const auto numbers = archive.get<double>(path);
    std::vector<RockPose> poses;
    for (auto p = numbers.begin(); p != numbers.end(); p += 7)
        poses.push_back({Vec3(p[0], p[1], p[2]), Quat(p[3], p[4], p[5], p[6])});
    return poses;
}

void save_run(Archive& archive, const ModelRun& run) {
    save_curves(archive, "run/points", run.curves);
    put_stages(archive, "run/displacement", run.displacement);
    put_stages(archive, "run/rotation", run.rotation);
    archive.put("run/rocks", std::span<const EntityId>(run.rocks));
    archive.put("run/shell", std::span<const unsigned>(run.shell));
    save_poses(archive, "run/start", run.start);
    put_fields(archive, "run/numbers", numbers_of(run));
    save_records(archive, "run/analyses", run.analyses);
}

ModelRun load_run(const Archive& archive) {
    ModelRun run;
    run.curves = load_curves(archive, "run/points");
    run.displacement = get_stages(archive, "run/displacement", run.curves.size());
    run.rotation = get_stages(archive, "run/rotation", run.curves.size());
    run.rocks = archive.get<EntityId>("run/rocks");
    run.shell = archive.get<unsigned>("run/shell");
    run.start = load_poses(archive, "run/start");
    get_fields(archive, "run/numbers", numbers_of(run));
    run.analyses = load_records(archive, "run/analyses");
    return run;
}

CheckpointedRun::CheckpointedRun(const Common& common, const TriaxialSettings& settings,
                                 const Archive& specimen, const ModelVariant& variant)
    : name_(variant.name) {
    Archive all;
    put_variant(all, settings, variant);
    // equal variants with different names may run at the same time
    all.put("name", std::span<const char>(variant.name));
    const std::array parts{fingerprint(all), fingerprint(specimen), common.seed};
    Archive whole;
    whole.put("parts", std::span<const std::uint64_t>(parts));
    const auto file = fmt::format("{:016x}.ckpt.h5", fingerprint(whole));
    file_ = common.out / folder / file;
    if (std::filesystem::is_directory(common.resume)) before_ = common.resume / folder / file;
}

std::optional<Archive> CheckpointedRun::resume() const {
    if (before_.empty() || !std::filesystem::exists(before_)) return {};
    return read_checkpoint(before_).state;
}

void CheckpointedRun::save(const Archive& archive) {
    if (file_.empty()) return;
    std::filesystem::create_directories(file_.parent_path());
    write_checkpoint(file_, {"model_run", 0, {{"name", name_}}, archive});
}

void remove_checkpoints(const Common& common) { std::filesystem::remove_all(common.out / folder); }

} // namespace bris
