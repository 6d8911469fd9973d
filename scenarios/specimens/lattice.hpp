#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace bris {

/// A cubic lattice in a block.
struct SiteLattice {
    Vec3 low, high;      ///< m, corners of the block
    double pitch = 0;    ///< m
    double shift = 0.02; ///< greatest random shift of a site, relative to the pitch
    std::uint64_t seed = 1;
};

/// Returns the first `count` sites for which `inside` is true, from the lowest plane of sites
/// upwards, each shifted at random. Throws InputError if the block has fewer.
std::vector<Vec3> lattice_sites(const SiteLattice& lattice, std::size_t count,
                                const std::function<bool(const Vec3&)>& inside);

} // namespace bris
