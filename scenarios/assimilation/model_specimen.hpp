#pragma once

#include "engine/options.hpp"
#include "scenarios/assimilation/run_models.hpp"
#include "scenarios/specimens/relax.hpp"

#include <cstdint>
#include <string>

namespace bris {

/// What a model does not know of the specimen that it is a model of.
struct ModelMismatch {
    double placement = 0; ///< m, by which each rock is off its true place, in a random direction
    double turn = 0;      ///< rad, likewise about a random axis
    unsigned spheres = 0; ///< of each rock in the model; 0: as many as in the truth
    std::uint64_t packing = 0; ///< seed of another packing around the sensor rocks; 0: the truth's

    bool any() const { return placement > 0 || turn > 0 || spheres > 0 || packing > 0; }
    /// Deviation of ln q between specimens that differ so and are otherwise alike; 0: nothing
    /// differs.
    double specimen_scatter() const;
    /// Name of a folder, different for each, as model_8_spheres_2_mm.
    std::string name() const;
    void describe(auto& option);
};

/// By how much rocks stand apart when shearing begins.
struct StartDifference {
    double distance = 0, sensor_distance = 0; ///< m, root mean square over all rocks, and over the
                                              ///< sensor rocks (0: there are none)
    double angle = 0, sensor_angle = 0;       ///< rad, likewise
};
/// Of runs of the same rocks in the same order.
StartDifference start_difference(const ModelRun& a, const ModelRun& b);

/// Of a scenario, for a specimen by another seed in a folder of its own beside the truth's; it goes
/// on from there if it was kept.
Common common_of_packing(const Common& common, const std::string& folder, std::uint64_t seed);

/// Another packing of other rocks of the same grading, with the sensor rocks of a scene in their
/// places; `common` is of that packing.
PreparedSpecimen make_another_packing(const Triaxial& described, const TriaxialSettings& settings,
                                      const TriaxialScene& scene, unsigned spheres,
                                      const Common& common, const ReportProgress& report);

/// Puts the rocks of a prepared specimen, of other balls and a little off their places, into a
/// mould as wide and high: they push each other apart without friction until none overlaps by more
/// than a hundredth of a ball (relax), and stand where pressure begins to matter. Throws
/// SimulationError where that does not succeed.
Relaxed fill_like(Simulation& simulation, TriaxialTest& test, const TriaxialScene& scene,
                  const PreparedSpecimen& truth, const ModelMismatch& mismatch, std::uint64_t seed);

/// The specimen of a model that errs so about a true one. One of the same packing is made from the
/// other (fill_like): in the same mould, so as dense, and it is consolidated as the truth is.
/// Agitation is left out: it would carry the rocks farther from their places than the deviation
/// asked for, and make the specimen denser than the truth. Another packing is made from the
/// beginning. Kept as NAME/specimen.ckpt.h5 in the folder of the results, and taken from there by
/// --resume.
PreparedSpecimen make_model_specimen(const Triaxial& described, const TriaxialSettings& settings,
                                     const PreparedSpecimen& truth, const ModelMismatch& mismatch,
                                     const Common& common, const ReportProgress& report);

void ModelMismatch::describe(auto& option) {
    option("model_placement", placement, "m",
           "by which each rock of the model starts off its true place, before what overlaps is "
           "relaxed away",
           within(0, 5e-3));
    option("model_turn", turn, "rad", "likewise, turned about a random axis", within(0, 0.3));
    option("model_spheres", spheres, "",
           "of each rock in the model, in the same places; 0: those of the truth", within(0, 200));
    option("model_packing", packing, "",
           "seed of another packing of the model, with the sensor rocks in the same places; 0: "
           "that of the truth");
}

} // namespace bris
