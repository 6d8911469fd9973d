#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <functional>

namespace bris {

constexpr auto specimen_file = "specimen.ckpt.h5";

/// A specimen that is filled and compacted; the confining pressure has not been applied yet.
struct MadeSpecimen {
    Archive state;
    double core_porosity = 0;
    std::uint64_t steps = 0; ///< since filling began, without trial consolidations
    StepCount count;         ///< steps and wall time of this process, with trial consolidations
    bool was_kept = false;   ///< made before, and taken from the store of beds
};

/// Throws InputError, listing all differing settings, if --resume names a specimen that was made
/// with others than those of this run. Scenarios call this before they print anything.
void require_same_specimen(const Common& common);

/// Makes the specimen of a scene, up to the moment before the confining pressure is applied, on
/// `common.threads` threads. A trial consolidation of a copy decides whether its core has the
/// porosity asked for when shearing begins; otherwise it is prepared again. If `common.resume`
/// names a checkpoint of the specimen, or a folder with one, it continues from there. The specimen
/// is saved as specimen.ckpt.h5 in the results folder: one specimen serves for many tests, whose
/// settings may differ. The store of beds has it afterwards, and gives one that was made before
/// (BedStore). `begin` places the rocks of a specimen that is neither filled nor tried, nor
/// kept.
/// Throws InputError, SimulationError, Interrupted, OutputError.
MadeSpecimen make_specimen(const TriaxialScene& scene, const TriaxialSettings& settings,
                           const Common& common, const ReportProgress& report,
                           const std::function<void(Simulation&, TriaxialTest&)>& begin = {});

} // namespace bris
