#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <functional>

namespace bris {

constexpr auto specimen_file = "specimen.ckpt.h5";

/// A specimen that is packed and compacted; the confining pressure has not acted yet.
struct MadeSpecimen {
    Archive state;
    double core_porosity = 0;
    std::uint64_t steps = 0; ///< since the first rock was poured
    StepCount count;         ///< of this process
};

/// Makes the specimen of a scene, up to where the confining pressure begins to matter, on
/// `common.threads` threads, or goes on from `common.resume`: a checkpoint of it, or a folder with
/// one. Saves it as specimen.ckpt.h5 in the folder of the results: one specimen serves for many
/// tests, and the settings of a test may differ. `begin` places the rocks where they are not to be
/// poured. Throws InputError, SimulationError, Interrupted, OutputError.
MadeSpecimen make_specimen(const TriaxialScene& scene, const TriaxialSettings& settings,
                           const Common& common, const ReportProgress& report,
                           const std::function<void(Simulation&, TriaxialTest&)>& begin = {});

} // namespace bris
