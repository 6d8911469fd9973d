#pragma once

#include "engine/entity.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// What the step needs to know of the bodies as a whole. It changes only when candidate pairs are
/// made.
struct Census {
    static constexpr auto name = "census";
    double largest_radius = 0;       ///< m, bounding radius of a body with spheres
    double smallest_free_radius = 0; ///< m, infinite where no body is free
    double largest_grain_mass = 0;   ///< kg, of a free body with spheres
    std::vector<Row> boundaries;     ///< rows of the bodies without spheres
    /// Bodies with spheres and boundaries, by material.
    std::vector<std::uint32_t> grains, hosts;
};

} // namespace bris
