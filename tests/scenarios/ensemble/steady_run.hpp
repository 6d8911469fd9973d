#pragma once

#include "engine/signal/attitude.hpp"
#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/specimens/recorded_motion.hpp"

#include <cmath>

namespace bris::testing {

/// A run of three sensor rocks that move and turn steadily over 1 % of strain.
inline ModelRun steady_run() {
    ModelRun run;
    run.sensors = 3;
    for (int s = 0; s < 3; ++s) {
        run.rocks.push_back(static_cast<EntityId>(s));
        run.start.push_back(
            {Vec3(0.03 * s, 0.05, 0.1), exponential_map(Vec3(0.4 * s, 1, -0.3 * s))});
    }
    for (int stage = 0; stage <= 100; ++stage) {
        const auto p = run.curves.add_row();
        p[quantity::axial_strain] = 1e-4 * stage;
        p[quantity::deviatoric_stress] = 1e5 * (1 - std::exp(-stage / 20.0));
        p[quantity::volumetric_strain] = -1e-5 * stage;
        for (std::size_t r = 0; r < 8; ++r) p.part(quantity::ring_radius, r) = 0.075 + 1e-6 * stage;
        run.displacement.emplace_back();
        run.rotation.emplace_back();
        for (int s = 0; s < 3; ++s) {
            run.displacement.back().push_back(1e-5 * stage * Vec3(1, s, -1));
            run.rotation.back().push_back(1e-3 * stage * Vec3(0.3 * s, -0.2, 1));
        }
    }
    return run;
}

inline TriaxialScene scene_of(const ModelRun& run) {
    TriaxialScene scene;
    for (std::size_t s = 0; s < run.sensors; ++s)
        scene.poses.push_back({run.start[s].position, run.start[s].orientation});
    return scene;
}

/// Recordings of a run, in rocks that were placed where they are at its start.
inline std::vector<Recording> placed(std::vector<Recording> recordings, const ModelRun& run) {
    return with_poses(std::move(recordings), scene_of(run).specimen, scene_of(run).poses);
}

} // namespace bris::testing
