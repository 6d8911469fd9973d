#pragma once

#include "scenarios/assimilation/model_run.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <limits>

namespace bris {

/// Root mean square differences of a model from a test, over the strains that both have, up to one;
/// NaN where nothing was measured.
struct Misfit {
    double q = 0, volumetric_strain = 0; ///< Pa, -
    double ring_strain = 0;              ///< -, at the end of the run, wherever the others end
    double sensor_displacement = 0;      ///< m
};
Misfit misfit_of(const ModelRun& run, const RecordedTest& test,
                 double last_strain = std::numeric_limits<double>::infinity());

} // namespace bris
