#pragma once

#include "scenarios/library/library_use.hpp"
#include "scenarios/records/draw_curves.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The radial strains of the rings of the membrane, from below, at one axial strain of a measured
/// test; estimated by a library from what was measured at the same strain (RingProfile).
struct RingEstimate {
    std::string not_made = "nothing has been measured yet"; ///< why there is none; empty: it is
    std::string without_sensors;         ///< why the sensor rocks were not used; empty: they were
    double strain = 0;                   ///< axial
    std::vector<double> mean, low, high; ///< with the 90 % band
    std::vector<double> scaled_mean;     ///< the library's mean profile with the measured volume
};

/// Estimates the rings at the last of the library's coarse strains that `strain` has reached, from
/// the volumetric strain and the displacements of the sensor rocks. Sensor rocks are used if all of
/// them are tracked, stand where those of the library stand, and none was displaced as no rock of
/// the library (SensorPredictive).
RingEstimate estimate_rings(const SpecimenLibrary& library, const ModelOfTest& model,
                            const RecordedTest& test, double strain);

/// One line for the user: what was used, the widest ring, and why the estimate was not made.
std::string sentence_of(const RingEstimate& rings);

/// Writes a line for each ring: estimate with its band, mean profile, measured. Throws OutputError.
void write_rings(const std::filesystem::path& csv, const RingEstimate& rings,
                 const std::vector<double>& measured);

/// Mean and band for a plot of radial strain in per cent against the number of the ring. Without a
/// label it says what was used.
std::vector<Curve> curves_of(const RingEstimate& rings, const std::string& label = "");

} // namespace bris
