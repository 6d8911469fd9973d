#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bris {

/// Point `number` of an additive low-discrepancy sequence in the unit cube [0, 1)^`dimensions`:
/// frac(1/2 + number / g^i), i = 1 ... dimensions, where g > 1 solves g^(dimensions + 1) = g + 1
/// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"). Any number of first
/// points fills the cube evenly. `dimensions`: 1 to 16. Throws InputError outside this range.
std::vector<double> low_discrepancy_point(std::uint64_t number, std::size_t dimensions);

} // namespace bris
