#pragma once

#include "components/clump.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Reads a clump: columns x, y, z, radius in units of the sieve size, principal frame, origin in
/// the centre of mass; comment lines "# volume = ...", "# inertia_x = ..." (and y, z), "# sieve =
/// ..." in the same units. The name is that of the file. The stored values are checked against a
/// coarse recomputation (128 × 128 columns, good to 2e-4): volume and inertia to 1e-3, centre,
/// products of inertia to 1e-3, sieve size to 1e-3. About 5 ms. Throws InputError with file (and
/// line), what was expected and what was found.
Clump read_clump(const std::filesystem::path& path);

/// All clumps of a directory in the order of their file names; `report.csv` is not a clump and is
/// left out. Throws InputError if there is none.
std::vector<Clump> read_clumps(const std::filesystem::path& directory);

/// Writes a clump so that read_clump returns the same bits. Throws OutputError.
void write_clump(const std::filesystem::path& path, const Clump& clump,
                 const std::vector<std::string>& comments);

} // namespace bris
