#pragma once

#include "engine/estimation/hybrid_regression.hpp"
#include "engine/options.hpp"
#include "scenarios/library/specimen_library.hpp"
#include "scenarios/specimens/material_card_file.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace bris {

/// The measurements of a specimen that are assimilated.
struct LibraryObservations {
    double strain = 0.01; ///< axial strain up to which there are measurements
    bool force = true;    ///< q
    bool volume = true;   ///< volumetric strain
    bool rings = false;   ///< radial strain of the rings, at `strain`
    bool tracked = false; ///< displacement and rotation of the sensor rocks, before `strain`
    bool tilt = false;    ///< rotation of the sensor rocks about horizontal axes only
    /// Porosity of the core at the start of shearing, which mass and volume give in a laboratory.
    bool porosity = true;

    bool any() const { return force || volume || rings || tracked || tilt || porosity; }
    void declare_options(auto& option);
};

/// Numbers that a library predicts, as the columns of a matrix: for some of its pressures, by
/// strain, ln q, ln of smoothed q, volumetric strain, radial strain of the rings; on request the
/// motion of the sensor rocks and the displacement field.
class LibraryTargets {
public:
    /// `pressures`: indices into those of the library.
    LibraryTargets(const SpecimenLibrary& library, std::vector<std::size_t> pressures, bool motion);

    enum Block { q, smoothed_q, volume, rings, sensors, field };
    /// First column of a block for the `pressure`-th of the pressures; columns follow by strain.
    Eigen::Index column(std::size_t pressure, Block block) const;
    /// Columns of a block for each strain.
    Eigen::Index width(Block block) const { return widths_[block]; }
    /// Number of strains of a block.
    Eigen::Index length(Block block) const { return lengths_[block]; }
    Eigen::Index count() const { return count_; }
    const std::vector<std::size_t>& pressures() const { return pressures_; }

    Vector values(const LibrarySpecimen& specimen) const;
    /// Targets that are regularised alike: a block up to 2 % of strain, from 2 to 4 %, and beyond.
    std::vector<TargetGroup> groups() const;

private:
    const SpecimenLibrary& library_;
    std::vector<std::size_t> pressures_;
    std::vector<Eigen::Index> widths_, lengths_; // lengths: number of strains
    Eigen::Index count_ = 0, per_pressure_ = 0;
};

/// The features of a specimen: ln q and volumetric strain at up to ten strains, and what else is
/// observed. `pressure`: index of the pressure at which it was measured.
Vector features_of(const SpecimenLibrary& library, const LibrarySpecimen& specimen,
                   std::size_t pressure, const LibraryObservations& observed);
/// Weights of these features: one over the square root of their number within each block, so that
/// blocks of many correlated numbers do not outweigh the others.
Vector weights_of(const SpecimenLibrary& library, const LibraryObservations& observed);

/// The parameters of a specimen, as columns of the regression that estimates them.
struct ParameterColumn {
    static constexpr Eigen::Index ln_friction = 0, ln_stiffness = 1, porosity = 2;
};

/// The features from which parameters are estimated: for each block that is observed, one number:
/// ln of the mean of q, volumetric strain at the last strain, porosity. Parameters are single
/// targets, for which the strength of regularisation is chosen from few residuals; with ten
/// correlated numbers of a block it is often chosen too low, and the estimates are too far from the
/// mean. If neither q nor volume is observed, the features are those of the curves.
Vector parameter_features_of(const SpecimenLibrary& library, const LibrarySpecimen& specimen,
                             std::size_t pressure, const LibraryObservations& observed);

/// What a library predicts for one specimen at one pressure, with 90 % bands.
struct LibraryPrediction {
    /// By strain of the library's axis: q, smoothed q, volumetric strain, radial strains of rings.
    TestCurves curves;
    TestCurves motion; ///< by coarse strain: sensor_motion, displacement_field; if requested
    NumberWithBand friction, stiffness, porosity;
    /// Distance of the measurements from those of the library, relative to one that 95 % of its
    /// specimens do not exceed: beyond 1 the bands are widened in proportion.
    double distance = 0;
};

/// Predicts specimens from measurements, with the empirical covariances of a library.
class LibraryPredictor {
public:
    /// `measured_at`: index of the pressure of the measurements; `predicted_at`: of the prediction;
    /// `motion`: predict sensor rocks and displacement field too. Throws InputError if nothing is
    /// observed, or if the library has too few specimens or strains.
    LibraryPredictor(const SpecimenLibrary& library, const LibraryObservations& observed,
                     std::size_t measured_at, std::size_t predicted_at, bool motion = false);

    /// `measured` needs only what is observed, up to the last observed strain.
    LibraryPrediction predict(const LibrarySpecimen& measured) const;
    LibraryPrediction prior() const; ///< without measurements
    /// Weights of the specimens of the library, which sum up to 1.
    std::vector<double> weights(const LibrarySpecimen& measured) const;
    const HybridRegression& regression() const { return regression_; }
    const HybridRegression& parameters() const { return parameters_; }

private:
    LibraryPrediction described(const HybridRegression::Prediction& curves,
                                const HybridRegression::Prediction& parameters) const;

    const SpecimenLibrary& library_;
    LibraryObservations observed_;
    std::size_t measured_at_;
    LibraryTargets targets_;
    HybridRegression regression_, parameters_;
};

/// A regression of the parameters (ParameterColumn) on their features over the specimens of a
/// library.
HybridRegression parameter_regression_of(const SpecimenLibrary& library,
                                         const LibraryObservations& observed,
                                         std::size_t measured_at);

/// A regression of targets on features over the specimens of a library.
HybridRegression regression_of(const SpecimenLibrary& library, const LibraryObservations& observed,
                               std::size_t measured_at, const LibraryTargets& targets);

void LibraryObservations::declare_options(auto& option) {
    option("learning_strain", strain, "", "Axial strain up to which measurements are assimilated.",
           within(1e-4, 0.12));
    option("use_force", force, "", "Assimilate q.");
    option("use_volume", volume, "", "Assimilate the volumetric strain.");
    option("use_rings", rings, "",
           "Assimilate the radial strain of the rings at --learning-strain.");
    option("use_sensors", tracked, "",
           "Assimilate displacement and rotation of the sensor rocks at --learning-strain.");
    option("use_tilt", tilt, "", "Assimilate the tilt of the sensor rocks at --learning-strain.");
    option("use_porosity", porosity, "",
           "Assimilate the porosity of the core at the start of shearing, which a laboratory "
           "knows from mass and volume.");
}

} // namespace bris
