#pragma once

#include "engine/report.hpp"
#include "engine/signal/spectrum.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <string>

namespace bris {

/// Of the longest part without gaps; without densities if that is shorter than two segments.
Spectrum spectrum_of_longest(const Vibration& vertical);

/// Adds what a sensor called `name` has recorded of a passage: rms and peak of the vertical
/// acceleration, its level up to `load_band` (Hz, where it follows the load) and beyond, its power
/// in bands, its entropy, and the rms of the rates of rotation. `prefix`: of the keys, tells who
/// recorded. The mean of the first tenth of a second is the level at rest, while the first axle is
/// still far away. Throws InputError if there is no vertical.
void add_sensor_levels(Report& summary, const std::string& prefix, const std::string& name,
                       const Recording& recording, double load_band);

} // namespace bris
