#pragma once

#include "engine/options.hpp"
#include "scenarios/ensemble/model_ensemble.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <string>
#include <vector>

namespace bris {

/// Settings of the sequential estimation of friction and stiffness from a test.
struct Learning {
    /// Ensemble members in each of two generations; the first is drawn from the prior, the second
    /// from the estimate after the beginning of the test.
    unsigned members = 8;
    double first_strain = 2e-3; ///< axial strain to which the first generation runs
    double final_strain = 0.01; ///< axial strain up to which measurements are assimilated
    /// Axial strain over which q is averaged: half of the strain reached, within these limits.
    double first_window = 1e-4, window = 1e-3;
    /// Prior standard deviations of the logarithms of friction and stiffness.
    double friction_deviation = 0.3, stiffness_deviation = 0.4;
    /// Standard deviation of ln q by which the real specimen may be stronger or weaker than that of
    /// the model; dilation and widening differ by the same fraction.
    double specimen_scatter = 0;
    double force_noise = 0.01; ///< standard deviation of ln q as measured
    bool by_force = true;      ///< assimilate q
    bool by_sensors = true;    ///< assimilate the outward displacement of the sensor rocks
    bool by_volume = false;    ///< assimilate the volumetric strain

    void declare_options(auto& option);
};

/// The prior distribution of the logarithms of friction and stiffness.
Gaussian prior_of(const RockParameters& middle, const Learning& settings);

/// The parameter estimate at an axial strain.
struct EstimateAt {
    double strain;
    Gaussian estimate;
    /// Of the last measurement of q against its predictive distribution: chi squared with one
    /// degree of freedom; -1: no q in this window.
    double normalised_innovation_squared;
    /// Values of q in this window that are outliers to the whole ensemble and are not assimilated.
    unsigned rejected = 0;
};

/// Estimates the parameters window by window up to `final_strain`, using no measurement before its
/// strain: from the logarithm of q, from the mean outward displacement of the sensor rocks, and
/// from the volumetric strain, each as far as it is measured and requested. Values of q that are
/// outliers to the whole ensemble are left out.
std::vector<EstimateAt> learn(const Gaussian& prior, const Ensemble& members,
                              const Measurements& measured, const Learning& settings,
                              double final_strain);

/// Number of displacements of sensor rocks that are outliers to the whole ensemble; `learn` leaves
/// them out.
std::size_t outlying_displacements(const Ensemble& members, const Measurements& measured);

/// Axial strains at which windows end, up to `final_strain`.
std::vector<double> window_ends(const Learning& settings, double final_strain);

void Learning::declare_options(auto& option) {
    option("members", members, "",
           "Number of ensemble members in each of the two generations from which friction and "
           "stiffness are estimated.",
           within(6, 1000));
    option("first_strain", first_strain, "", "Axial strain to which the first generation runs.",
           above(0, 1));
    option("learning_strain", final_strain, "",
           "Axial strain up to which measurements are assimilated.", above(0, 1));
    option("learning_window", window, "", "Largest axial strain over which q is averaged.",
           above(0, 1));
    option("friction_deviation", friction_deviation, "",
           "Prior standard deviation of the logarithm of friction.", above(0, 10));
    option("stiffness_deviation", stiffness_deviation, "",
           "Prior standard deviation of the logarithm of stiffness.", above(0, 10));
    // a scenario that knows how the specimen of its model differs sets it below 0
    const bool by_model = specimen_scatter < 0;
    option("specimen_scatter", specimen_scatter, "",
           std::string("Standard deviation of ln q by which the real specimen may be stronger or "
                       "weaker than that of the model for other reasons than its parameters.") +
               (by_model ? " Below 0: the value for the differences set by the --model-... options."
                         : ""),
           within(by_model ? -1 : 0, 10));
    option("force_noise", force_noise, "", "Relative standard deviation of q as measured.",
           within(0, 10));
    option("learn_by_force", by_force, "", "Estimate the parameters from q.");
    option("learn_by_sensors", by_sensors, "",
           "Estimate the parameters from the outward displacement of the sensor rocks, where it "
           "was recorded.");
    option("learn_by_volume", by_volume, "", "Estimate the parameters from the volumetric strain.");
}

} // namespace bris
