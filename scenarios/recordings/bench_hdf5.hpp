#pragma once

#include "scenarios/recordings/synchronise.hpp"
#include "scenarios/recordings/triaxial_point.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// What a test machine measured, record by record.
struct Bench {
    std::vector<TriaxialPoint>
        points; ///< strain, q, volumetric strain and ring radii; NaN: not measured
    MachineClock clock = {};
};

/// Whether a file of recordings has the group /bench. Throws OutputError.
bool has_bench(const std::filesystem::path& path);

/// From the group /bench of an HDF5 file: time (s), strain (axial), force (N, of the piston beside
/// what the confining pressure carries) and confining (Pa), a number a record, and where measured
/// volumetric_strain, phase and ring_radius (n x rings, m); attribute area: of the specimen at the
/// start (m2). Stress is force over the area as it is by then, area (1 - volumetric) / (1 - axial
/// strain) (ASTM D7181), with the last volumetric strain that was measured. Throws InputError where
/// shapes or numbers do not fit, or the confining pressure (median) is not `pressure` within 5 %;
/// OutputError where the file cannot be read.
Bench read_bench(const std::filesystem::path& path, double pressure);

/// Adds that group to a file of recordings. `time`: s, of each point. Throws OutputError.
void write_bench(const std::filesystem::path& path, const std::vector<TriaxialPoint>& points,
                 const std::vector<double>& time, double area, double pressure);

} // namespace bris
