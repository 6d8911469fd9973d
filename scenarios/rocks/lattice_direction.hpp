#pragma once

#include "engine/math.hpp"

#include <cmath>
#include <cstddef>

namespace bris {

/// Point k of n points spread evenly over the unit sphere (Fibonacci lattice).
inline Vec3 lattice_direction(std::size_t k, std::size_t n) {
    constexpr double golden_angle = 2.399963229728653; // pi (3 - sqrt 5)
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(n);
    const double angle = golden_angle * static_cast<double>(k), s = std::sqrt(1 - z * z);
    return {s * std::cos(angle), s * std::sin(angle), z};
}

} // namespace bris
