#pragma once

#include "components/clump.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Reads a clump from a CSV file with the columns x, y, z, radius, a row for each sphere, in units
/// of the sieve size; the axes are the principal axes and the origin is the centre of mass. The
/// comment lines "# volume = ...", "# inertia_x = ..." (and y, z) and "# sieve = ..." give the mass
/// properties in the same units. The clump is named after the file. The stored values are compared
/// with a coarse recomputation (128 × 128 columns, accurate to 2e-4): volume, moments and products
/// of inertia, centre of mass and sieve size must agree to 1e-3. Takes about 5 ms. Throws
/// InputError with the file (and line), what was expected and what was found.
Clump read_clump(const std::filesystem::path& path);

/// Reads all clumps of a directory, in the order of the file names. `report.csv` is not a clump and
/// is skipped. Throws InputError if the directory contains no clump.
std::vector<Clump> read_clumps(const std::filesystem::path& directory);

/// Writes a clump such that read_clump returns the same bits. Throws OutputError.
void write_clump(const std::filesystem::path& path, const Clump& clump,
                 const std::vector<std::string>& comments);

} // namespace bris
