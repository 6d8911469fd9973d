#pragma once

#include "components/clump.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace bris::peers {

/// The bed from which every code starts, at rest and without contact history: a box with a corner
/// at the origin, and the spheres in it. The file has a line "N Lx Ly Lz" and then a line "x y z r"
/// (m) for each sphere. If the spheres belong to clumps, the number of the clump, counted from 1,
/// follows in each line, and the spheres of a clump are in consecutive lines.
struct Bed {
    Vec3 box = Vec3::Zero(); ///< m, sides
    std::vector<Ball> balls;
    std::vector<std::size_t> rocks; ///< clump of each sphere; empty: each sphere is a body
};

/// Reads a bed. Throws InputError with file and line, what was expected and what was found.
Bed read_bed(const std::filesystem::path& path);

/// Writes a bed so that read_bed returns the same bits. Throws OutputError.
void write_bed(const std::filesystem::path& path, const Bed& bed);

} // namespace bris::peers
