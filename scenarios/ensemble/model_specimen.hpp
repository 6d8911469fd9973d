#pragma once

#include "engine/options.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/specimens/relax.hpp"

#include <cstdint>
#include <string>

namespace bris {

/// Differences between the specimen of a model and the true specimen.
struct ModelMismatch {
    double placement = 0;      ///< m, displacement of each rock, in a random direction
    double rotation = 0;       ///< rad, rotation of each rock, about a random axis
    unsigned spheres = 0;      ///< spheres of each rock in the model; 0: as many as in the truth
    std::uint64_t packing = 0; ///< seed of another packing around the sensor rocks; 0: the truth's

    bool any() const { return placement > 0 || rotation > 0 || spheres > 0 || packing > 0; }
    /// Standard deviation of ln q between specimens that differ in this way and are otherwise
    /// alike; 0 if nothing differs.
    double specimen_scatter() const;
    /// Name of a folder, unique for each mismatch, as model_8_spheres_2_mm.
    std::string name() const;
    void declare_options(auto& option);
};

/// Differences between the poses of the rocks of two runs when shearing begins.
struct StartDifference {
    /// m, root mean square over all rocks, and over the sensor rocks (0 without sensor rocks).
    double distance = 0, sensor_distance = 0;
    double angle = 0, sensor_angle = 0; ///< rad, the same for rotations
};
/// The differences between two runs of the same rocks in the same order. Throws InputError if the
/// numbers of rocks differ.
StartDifference start_difference(const ModelRun& a, const ModelRun& b);

/// Common settings for making a specimen with another seed, in a subfolder of the results; resumes
/// from that subfolder of --resume if its specimen was saved there.
Common common_of_packing(const Common& common, const std::string& folder, std::uint64_t seed);

/// Makes another packing: other rocks of the same grading around the sensor rocks of a scene, which
/// keep their given poses. `common` comes from common_of_packing.
PreparedSpecimen make_another_packing(const Triaxial& described, const TriaxialSettings& settings,
                                      const TriaxialScene& scene, unsigned spheres,
                                      const Common& common, const ReportProgress& report);

/// Places the rocks of a prepared specimen, displaced, rotated or of other spheres, into a mould of
/// the same width and height. They push each other apart without friction until no overlap exceeds
/// a hundredth of a sphere's diameter (relax). The specimen is then ready for the confining
/// pressure. Throws SimulationError if the overlaps cannot be relaxed.
Relaxed fill_like(Simulation& simulation, TriaxialTest& test, const TriaxialScene& scene,
                  const PreparedSpecimen& truth, const ModelMismatch& mismatch, std::uint64_t seed);

/// Makes the specimen of a model that differs from the true specimen by a mismatch. With the same
/// packing it is made from the true specimen (fill_like), in the same mould and therefore of the
/// same density, and is then consolidated like the true one. Vibration is left out: it would move
/// the rocks farther from their positions than the given displacement, and make the specimen denser
/// than the true one. Another packing is made from the beginning. The specimen is saved as
/// NAME/specimen.ckpt.h5 in the results folder, from which --resume reads it.
PreparedSpecimen make_model_specimen(const Triaxial& described, const TriaxialSettings& settings,
                                     const PreparedSpecimen& truth, const ModelMismatch& mismatch,
                                     const Common& common, const ReportProgress& report);

void ModelMismatch::declare_options(auto& option) {
    option("model_placement", placement, "m",
           "Distance by which each rock of the model is displaced from its true position, in a "
           "random direction, before overlaps are relaxed.",
           within(0, 5e-3));
    option("model_rotation", rotation, "rad",
           "Angle by which each rock of the model is rotated from its true orientation, about a "
           "random axis.",
           within(0, 0.3));
    option("model_spheres", spheres, "",
           "Number of spheres of each rock in the model, at the same positions; 0: the rocks of "
           "the truth.",
           within(0, 200));
    option("model_packing", packing, "",
           "Seed of another packing for the model, with the sensor rocks at the same positions; "
           "0: the packing of the truth.");
}

} // namespace bris
