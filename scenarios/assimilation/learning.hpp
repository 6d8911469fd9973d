#pragma once

#include "engine/options.hpp"
#include "scenarios/assimilation/model_ensemble.hpp"
#include "scenarios/recordings/measured_test.hpp"

#include <string>
#include <vector>

namespace bris {

/// How friction and stiffness are learned while a test goes on.
struct Learning {
    unsigned members = 8; ///< in each of two generations: drawn from what is known before the test,
                          ///< and after its beginning
    double first_strain = 2e-3; ///< to which the first generation runs
    double final_strain = 0.01; ///< to which learning goes on
    double first_window = 1e-4,
           window = 1e-3; ///< of axial strain, over which q is averaged: half of it, within these
    double friction_deviation = 0.3,
           stiffness_deviation = 0.4; ///< of their logarithms, before anything is measured
    double specimen_scatter = 0; ///< by which the real specimen may be stronger or weaker than the
                                 ///< model's, of ln q; and by the same share dilate and widen
    double force_noise = 0.01;   ///< of ln q as measured
    bool by_force = true;        ///< q
    bool by_sensors = true;      ///< how far sensor rocks move outwards
    bool by_volume = false;      ///< volumetric strain

    void describe(auto& option);
};

/// What is known of them before a test.
Gaussian prior_of(const RockParameters& middle, const Learning& settings);

/// What is known at an axial strain.
struct EstimateAt {
    double strain;
    Gaussian estimate;
    double normalised_innovation_squared; ///< of the last measurement of q from what was expected:
                                          ///< chi square of one degree; -1: none in this window
    unsigned rejected =
        0; ///< numbers of q in this window that no world comes near: not learned from
};

/// Learns window by window up to `final_strain`, from no measurement before its time: from the
/// logarithm of q, from how far the sensor rocks have moved outwards in the mean, and from the
/// volumetric strain, each as far as it is measured and asked for. A q that no world comes near is
/// left out.
std::vector<EstimateAt> learn(const Gaussian& prior, const Ensemble& members,
                              const MeasuredTest& measured, const Learning& settings,
                              double final_strain);

/// Displacements of sensor rocks that no world comes near: learning leaves them out.
std::size_t outlying_displacements(const Ensemble& members, const MeasuredTest& measured);

/// Where windows end, up to `final_strain`.
std::vector<double> window_ends(const Learning& settings, double final_strain);

void Learning::describe(auto& option) {
    option("members", members, "",
           "in each of two generations, that friction and stiffness are learned from",
           within(6, 1000));
    option("first_strain", first_strain, "", "to which the first generation runs", above(0));
    option("learning_strain", final_strain, "", "to which learning goes on", above(0));
    option("learning_window", window, "", "axial strain over which q is averaged", above(0));
    option("friction_deviation", friction_deviation, "",
           "of its logarithm, before anything is measured", above(0));
    option("stiffness_deviation", stiffness_deviation, "", "likewise", above(0));
    const bool by_model =
        specimen_scatter < 0; // a scenario that knows by what its model's specimen differs
    option("specimen_scatter", specimen_scatter, "",
           std::string("by which the real specimen may be stronger than the model's for other "
                       "reasons, of ln q") +
               (by_model ? "; below 0: by what --model-... differ in" : ""),
           at_least(by_model ? -1 : 0));
    option("force_noise", force_noise, "", "of q as measured, relative", at_least(0));
    option("learn_by_force", by_force, "", "that is, by q");
    option("learn_by_sensors", by_sensors, "",
           "by how far they move outwards, where that was recorded");
    option("learn_by_volume", by_volume, "", "by the volumetric strain");
}

} // namespace bris
