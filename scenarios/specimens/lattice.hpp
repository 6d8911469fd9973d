#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace bris {

/// Sites of a cubic lattice from the lowest layer up, those that `inside` lets through, each
/// shifted at random by up to `shift` of the pitch.
struct Lattice {
    Vec3 low, high;   ///< m, block that is searched
    double pitch = 0; ///< m
    double shift = 0.02;
    std::uint64_t seed = 1;
};

/// The first `count` sites. Throws InputError if the block does not have as many.
std::vector<Vec3> lattice_sites(const Lattice& lattice, std::size_t count,
                                const std::function<bool(const Vec3&)>& inside);

} // namespace bris
