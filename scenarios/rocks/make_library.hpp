#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/fill_clump.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A library of random rocks and what they are to look like. Defaults: crushed granite ballast; few
/// faces, since the angularity index of crushed rock (350 to 500) is reached with 8 to 14 faces,
/// while 18 to 30 faces give 250 to 330 (rounded gravel).
struct LibrarySettings {
    unsigned count = 10;
    std::uint64_t seed = 1;
    double least_flat_elongated = 1.2, median_flat_elongated = 1.8, greatest_flat_elongated = 2.8;
    unsigned fewest_faces = 9, most_faces = 15;
    bool cube = true;           ///< also the report's cubic SmartRock, as cube.csv
    FillSettings fill;          ///< number of spheres, least radius, method
    std::filesystem::path out;  ///< directory; made if it does not exist
    std::filesystem::path mesh; ///< STL or OBJ: one clump of this shape instead of random rocks
};

/// One clump against its solid. Lengths in units of the solid's sieve size; errors relative to it.
struct LibraryRow {
    std::string name;
    Clump clump; ///< at sieve size 1 m
    int faces = 0;
    double volume = 0; ///< of the clump at sieve size 1, m³
    double volume_error = 0;
    double inertia_error = 0; ///< greatest of the three principal moments
    double to_clump_mean = 0, to_clump_max = 0, to_solid_mean = 0, to_solid_max = 0;
    double flat_elongated_solid = 0, flat_elongated_clump = 0;
    double angularity_solid = 0, angularity_clump = 0, hull_angularity_clump = 0; // degrees
    double sphericity_solid = 0; ///< area of the sphere of equal volume over the area
    double least_radius = 0, greatest_radius = 0;
    double level_set_mean = 0; ///< mean distance solid to clump if OpenVDB fills it, volume matched
};

/// Makes the clumps, writes rock_01.csv ... (or the mesh's name), cube.csv and report.csv into
/// `settings.out`, and returns the rows of the report. Same settings, same files. Throws InputError
/// for settings out of range or a bad mesh, OutputError if a file cannot be written.
std::vector<LibraryRow> make_library(const LibrarySettings& settings);

/// The rows as a table for people.
std::string describe(const std::vector<LibraryRow>& rows);

} // namespace bris
