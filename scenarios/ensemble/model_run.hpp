#pragma once

#include "engine/archive.hpp"
#include "scenarios/sensors/sensor_trajectory.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "systems/fusion/fuse.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// The parameters of the rocks that are estimated.
struct RockParameters {
    double friction = 0.7; ///< between rocks and between rock and platen, from consolidation on
    double stiffness = 1;  ///< factor on the contact stiffness of rocks in the scene's settings
};

/// Parameters that a model run is given from some axial strain on.
struct LearnedParameters {
    double strain;
    RockParameters rocks;
};

/// How the observations of sensors correct a model run.
struct Corrections {
    /// Process noise per unit of axial strain: drift (0.1 mm in a stage of 0.1 %) and turning.
    /// Velocities are known to be zero at the ends of stages, and are not carried from one to the
    /// next.
    FilterSettings filter{.acceleration_density = 1,
                          .angular_acceleration_density = 100,
                          .drift = 1e-5,
                          .turning = 0.1,
                          .gate = 1};
    unsigned injection_steps = 60; ///< steps over which a correction of position is applied
    NudgingSettings nudging;
    double largest_shift = 0; ///< m, of a rock in a step (Fusion); 0: no limit
    double position_noise = 1e-6, attitude_noise = 1e-4; ///< m and rad, of the trajectories
};

/// One variant of a model run of a triaxial test: its parameters and the observations that it
/// assimilates.
struct ModelVariant {
    std::string name = "model";
    RockParameters rocks;
    /// In order of strain. When the parameters change, the run starts again from the specimen and
    /// catches up.
    std::vector<LearnedParameters> learned = {};
    /// Of the sensor rocks, in their order; empty: no observations.
    std::vector<SensorTrajectory> trajectories = {};
    Corrections corrections = {};
};

struct RockPose {
    Vec3 position;    ///< m, of the centre of mass
    Quat orientation; ///< body to world frame
};

/// Largest shell index: rocks this many contacts or more from the nearest sensor rock share it.
inline constexpr unsigned farthest_shell = 4;

/// Motion of all rocks since the start of shearing, stage by stage, in the order of `rocks`.
struct ModelRun {
    TestCurves curves;                           ///< one row at the start, one for each stage
    std::vector<std::vector<Vec3>> displacement; ///< m, by stage and rock
    std::vector<std::vector<Vec3>> rotation;     ///< rad, rotation vectors, by stage and rock
    std::vector<EntityId> rocks;                 ///< sensor rocks first
    std::vector<RockPose> start;                 ///< poses at the start of shearing
    std::size_t sensors = 0;
    /// Number of contacts from the nearest sensor rock at the start: 0 for the sensor rocks
    /// themselves, at most farthest_shell.
    std::vector<unsigned> shell;
    /// J, work of the corrections, and of the boundaries (platens and membrane) while shearing.
    double fusion_work = 0, boundary_work = 0;
    /// Numbers of observed vectors that the filters accepted and rejected, and of steps.
    std::uint64_t accepted = 0, refused = 0, steps = 0;
    /// Numbers of corrections that were reduced and withheld because they exceeded the largest
    /// shift.
    std::uint64_t reduced = 0, withheld = 0;
    /// Axial strain from which the sensors are left out because they are inconsistent with the
    /// forecast, as those of another specimen would be (compute_analysis); 0: never.
    double inconsistent_from = 0;
    std::vector<AnalysisRecord> analyses = {}; ///< of the sensor rocks, in order of strain
    double wall_time = 0;                      ///< s
    double core_porosity = 0;                  ///< at the start of shearing
    std::string stopped = {}; ///< message of the guard that stopped the run; all else is empty
};

/// Observers of a run: `progress` is called after each block of steps, `stage` after each stage.
struct ModelWatch {
    ReportProgress progress = [](const PhaseProgress&) {};
    std::function<void(const World&, double strain)> stage = [](const World&, double) {};
};

/// The stage of a run nearest to the strain of a sample; nothing if the run does not reach it. Half
/// a stage is less than sensors can resolve.
std::optional<std::size_t> stage_of_sample(const ModelRun& run, double strain);

class CheckpointedRun;

/// Runs one variant from the prepared specimen to the end of the test, on one thread. With a
/// `checkpoint` (may be null) it saves checkpoints and resumes from them, to the same bits. Throws
/// SimulationError, and Interrupted when the user stops it.
ModelRun run_model(const TriaxialScene& scene, const TriaxialSettings& settings,
                   const Archive& specimen, const ModelVariant& variant,
                   const ModelWatch& watch = {}, CheckpointedRun* checkpoint = nullptr);

} // namespace bris
