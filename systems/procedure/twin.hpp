#pragma once

#include "systems/fusion/fuse.hpp"
#include "systems/procedure/triaxial_scene.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// What a run differs in from the truth, and what it is told.
struct TwinArm {
    std::string name;
    double friction = 0.7;       ///< rock on rock and platen, from consolidation on
    double stiffness = 1;        ///< of the true contact stiffness of rocks
    double disturbance = 0;      ///< m, random, of every rock's place at the start: chaos alone
    bool fused = false;          ///< gets the true run's recordings
    FilterSettings filter;       ///< by strain: drift and turning per unit of axial strain
    unsigned injection_steps = 60;
    PullSettings pull;
    bool spread = false;         ///< over the contact network
    double interval = 1e-4;      ///< axial strain between samples
    double position_noise = 1e-6, attitude_noise = 1e-4; ///< m and rad, of what is recorded
};

/// Motion of all rocks since the start of shearing, stage by stage, in the order of `rocks`.
struct TwinRun {
    std::vector<TriaxialPoint> points;           ///< one at the start, one for each stage
    std::vector<std::vector<Vec3>> displacement; ///< m, of each stage
    std::vector<std::vector<Vec3>> rotation;     ///< rad, rotation vectors, likewise
    std::vector<EntityId> rocks;                 ///< sensor rocks first
    std::size_t sensors = 0;
    std::vector<unsigned> shell;                 ///< contacts from the nearest sensor rock at the start; 0: itself
    double fusion_work = 0, platen_work = 0;     ///< J, of the corrections, and of the boundaries while shearing
    std::uint64_t accepted = 0, refused = 0, steps = 0; ///< vectors measured
    double wall_time = 0;                        ///< s
};

/// Runs one arm from the prepared specimen; `truth` is needed by a fused one. `watch` is told fraction and description.
TwinRun run_arm(const TriaxialScene& scene, const TriaxialSettings& settings, const Archive& specimen, const TwinArm& arm, const TwinRun* truth,
                std::uint64_t seed, const std::function<void(double, const std::string&)>& watch);

/// Root mean square errors against the truth, over stages (and rocks).
struct TwinErrors {
    double q = 0, volumetric_strain = 0, ring_radius = 0;           ///< Pa, -, m
    std::vector<double> displacement, rotation;                     ///< m and rad, by shell: sensors, 1, 2, 3, 4 and beyond
};
TwinErrors errors_of(const TwinRun& run, const TwinRun& truth);

} // namespace bris
