#pragma once

#include "engine/archive.hpp"
#include "scenarios/recordings/sensor_trajectory.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "systems/fusion/fuse.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// What a model believes of its rocks.
struct RockParameters {
    double friction = 0.7; ///< rock on rock and platen, from consolidation on
    double stiffness = 1;  ///< of contacts of rocks, of that in the scene's settings
};

/// From some strain on, another one.
struct LearnedParameters {
    double strain;
    RockParameters rocks;
};

/// How recordings correct a model.
struct Corrections {
    /// By strain: drift (0.1 mm in a stage of 0.1 %) and turning per unit of axial strain.
    /// Velocities are known to be none at stage ends, and forgotten in between.
    FilterSettings filter{.acceleration_density = 1,
                          .angular_acceleration_density = 100,
                          .drift = 1e-5,
                          .turning = 0.1,
                          .gate = 1};
    unsigned injection_steps = 60;
    NudgingSettings nudging;
    bool spread = false;           ///< over the contact network
    double largest_shift = 0;      ///< m, of a rock in a step (Fusion); 0: none
    double largest_work_share = 0; ///< that corrections may do of the boundaries' work, from
                                   ///< analysis to analysis (WorkBudget); 0: no limit
    double lateness = 0; ///< axial strain by which samples come late; filter.lag says how far back
                         ///< they may be taken
    double note_every = 1e-3; ///< strain between notes of the motion, for those
    double position_noise = 1e-6, attitude_noise = 1e-4; ///< m and rad, of the ways
};

/// One run of a model of a triaxial test, and what it is told.
struct ModelVariant {
    std::string name = "model";
    RockParameters rocks;
    std::vector<LearnedParameters> learned = {}; ///< in order of strain
    bool catch_up = false; ///< begin again from the specimen when the belief changes, and catch up;
                           ///< else go on from where it is
    double disturbance = 0; ///< m, random, of every rock's place at the start: chaos alone
    std::vector<SensorTrajectory> trajectories =
        {}; ///< of the sensor rocks, in their order; empty: none is told
    Corrections corrections = {};
};

struct RockPose {
    Vec3 position;    ///< m, of the centre of mass
    Quat orientation; ///< body to world
};

/// Rocks this many contacts from the nearest sensor rock, and farther, count as one.
inline constexpr unsigned farthest_shell = 4;

/// Motion of all rocks since the start of shearing, stage by stage, in the order of `rocks`.
struct ModelRun {
    std::vector<TriaxialPoint> points;           ///< one at the start, one for each stage
    std::vector<std::vector<Vec3>> displacement; ///< m, of each stage
    std::vector<std::vector<Vec3>> rotation;     ///< rad, rotation vectors, likewise
    std::vector<EntityId> rocks;                 ///< sensor rocks first
    std::vector<RockPose> start;                 ///< where they stood
    std::size_t sensors = 0;
    std::vector<unsigned> shell; ///< contacts from the nearest sensor rock at the start; 0: itself;
                                 ///< at most farthest_shell
    double fusion_work = 0, boundary_work = 0; ///< J, of the corrections, and of the boundaries
                                               ///< (platens and membrane) while shearing
    std::uint64_t accepted = 0, refused = 0, steps = 0; ///< vectors measured
    std::uint64_t too_late = 0, reduced = 0,
                  withheld = 0; ///< samples; corrections, for how far they go
    std::uint64_t too_costly = 0,
                  much_too_costly = 0; ///< corrections reduced and withheld for what they cost
    std::vector<std::vector<SmoothedPose>> smoothed =
        {}; ///< of each sensor rock, where filters look back: by what came up to their lag later
            ///< too
    double inconsistent_from = 0; ///< strain, from which on sensors seem to be of another specimen
                                  ///< and are left out (analyse); 0: never
    std::vector<AnalysisRecord> analyses = {}; ///< of the sensor rocks, in order of strain
    double wall_time = 0;                      ///< s
    double core_porosity = 0;                  ///< at the start of shearing
    std::string stopped = {};                  ///< by a guard, with what it said; all else is empty
};

/// Who watches a run: hears of its progress, and sees the world after each stage.
struct ModelWatch {
    ReportProgress progress = [](const PhaseProgress&) {};
    std::function<void(const World&, const TriaxialPoint&)> stage = [](const World&,
                                                                       const TriaxialPoint&) {};
};

/// The stage of a run nearest to a sample's strain; nothing: it goes not that far. Half a stage is
/// less than sensors tell apart.
std::optional<std::size_t> stage_of_sample(const ModelRun& run, double strain);

class CheckpointedRun;

/// Runs one arm from the prepared specimen, on one thread. Throws Interrupted when the user stops
/// it. `checkpoint`: where it is kept meanwhile, and taken up from; the bits are the same. Null:
/// nowhere.
ModelRun run_model(const TriaxialScene& scene, const TriaxialSettings& settings,
                   const Archive& specimen, const ModelVariant& variant, std::uint64_t seed,
                   const ModelWatch& watch = {}, CheckpointedRun* checkpoint = nullptr);

} // namespace bris
