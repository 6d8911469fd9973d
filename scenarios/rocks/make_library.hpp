#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/fill_clump.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Settings of a library of random rocks. The defaults describe crushed granite ballast. The number
/// of faces is small because 8 to 14 faces give the angularity index of crushed rock (350 to 500),
/// while 18 to 30 faces give 250 to 330 (rounded gravel).
struct LibrarySettings {
    unsigned count = 10;
    std::uint64_t seed = 1;
    double least_flat_elongated = 1.2, median_flat_elongated = 1.8, greatest_flat_elongated = 2.8;
    unsigned fewest_faces = 9, most_faces = 15;
    bool cube = true;          ///< also make the cubic SmartRock of the SmartRock report: cube.csv
    FillSettings fill;         ///< number of spheres, least radius, method
    std::filesystem::path out; ///< directory; created if it does not exist
    std::filesystem::path
        mesh; ///< STL, OBJ or PLY: one clump of this shape instead of random rocks
};

/// Comparison of one clump with the solid that it models. Lengths are in units of the sieve size of
/// the solid; errors are relative to the solid.
struct LibraryRow {
    std::string name;
    Clump clump; ///< at sieve size 1 m
    int faces = 0;
    double volume = 0; ///< of the clump at sieve size 1, m³
    double volume_error = 0;
    double inertia_error = 0; ///< greatest of the three principal moments
    /// Mean and greatest distance from the surface of the solid to the clump, and the reverse.
    double to_clump_mean = 0, to_clump_max = 0, to_solid_mean = 0, to_solid_max = 0;
    double flat_elongated_solid = 0, flat_elongated_clump = 0;
    double angularity_solid = 0, angularity_clump = 0, hull_angularity_clump = 0; ///< degrees
    /// Surface area of the sphere of equal volume over that of the solid.
    double sphericity_solid = 0;
    double least_radius = 0, greatest_radius = 0;
    /// Mean distance from the solid to the clump if OpenVDB fills it, with matched volume.
    double level_set_mean = 0;
    std::string simplification; ///< of a scan with too many triangles, as a sentence; "": none
};

/// Makes the clumps, writes rock_01.csv ... (or a file named after the mesh), cube.csv and
/// report.csv into `settings.out`, and returns the rows of the report. The same settings give the
/// same files. Throws InputError for settings out of range or an invalid mesh, OutputError if a
/// file cannot be written.
std::vector<LibraryRow> make_library(const LibrarySettings& settings);

/// The rows of the report as a table for people, without those columns that few need.
std::string sentence_of(const std::vector<LibraryRow>& rows);

} // namespace bris
