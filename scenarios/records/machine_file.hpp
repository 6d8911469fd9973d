#pragma once

#include "scenarios/records/test_curves.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Reads one test of a test machine from a CSV file with the columns axial_strain,
/// deviatoric_stress_Pa and, as far as they were measured, volumetric_strain and ring_N_radius_m
/// (test.csv of recordings, curve.csv of triaxial). `map`: column map of a file of another program;
/// empty: none. `option` and `map_option` are those that name the files, for messages. Throws
/// InputError with file:line, what was expected and what was found, and OutputError.
MeasuredCurves read_machine_file(const char* option, const std::filesystem::path& csv,
                                 const char* map_option, const std::filesystem::path& map);

} // namespace bris
