#pragma once

#include "engine/named_value.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// What load cycles have done to a specimen, as flat keys with unit suffixes, for summary.json:
/// permanent strains after 1, 10, 100 and so on cycles and after the last one, how much the axial
/// one grew in the last decade of cycles and in that before, and the response in the last cycle.
/// NaN: the test has not come so far.
std::vector<NamedValue> named_values_of(const CyclicState& cyclic);

/// Writes cycles.csv, a line for each cycle, and loops.csv, the points of those that are shown,
/// into a folder. Throws OutputError.
void write_cycles(const std::filesystem::path& folder, const CyclicState& cyclic);

/// The cycles of one test, with their label.
struct LabelledCycles {
    std::string label;
    const CyclicState* cyclic;
};

/// Draws permanent strains, resilient modulus and damping ratio against the logarithm of the number
/// of cycles, and the loops, of some tests as one PNG file. Returns false if gnuplot fails.
bool draw_cycles(const std::filesystem::path& png, const std::vector<LabelledCycles>& tests);

} // namespace bris
