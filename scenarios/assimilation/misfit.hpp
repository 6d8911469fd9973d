#pragma once

#include "scenarios/assimilation/model_run.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <limits>

namespace bris {

/// Root mean square differences between a model and a test, over the strains that both have; NaN
/// where nothing was measured.
struct Misfit {
    double q = 0, volumetric_strain = 0; ///< Pa, -
    double ring_strain = 0;              ///< -, at the end of the run, whatever the last strain
    double sensor_displacement = 0;      ///< m
};
/// The misfit up to `last_strain`.
Misfit misfit_of(const ModelRun& run, const RecordedTest& test,
                 double last_strain = std::numeric_limits<double>::infinity());

} // namespace bris
