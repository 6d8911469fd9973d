#pragma once

#include "components/clump.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace bris::peers {

/// The bed that every code starts from, at rest and without history: a box with a corner at the
/// origin and the spheres in it. As text: "N Lx Ly Lz", then a line "x y z r" (m) for each sphere,
/// followed by the number of its stone, counted from 1, if the spheres are those of stones; stones
/// stand together.
struct Bed {
    Vec3 box = Vec3::Zero(); ///< m
    std::vector<Ball> balls;
    std::vector<std::size_t> rocks; ///< of each ball; empty: each ball is a body of its own
};

/// Throws InputError with file and line, what was expected and what was found.
Bed read_bed(const std::filesystem::path& path);

/// Writes a bed so that read_bed returns the same bits. Throws OutputError.
void write_bed(const std::filesystem::path& path, const Bed& bed);

} // namespace bris::peers
