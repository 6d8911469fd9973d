#pragma once

#include "systems/fields/fouling.hpp"

#include <filesystem>

namespace bris {

/// Fines and water at the beginning.
struct InitialFouling {
    /// uniform: the same mass of fines per volume of voids; layered: the same, between two heights
    /// only; random: as uniform, times a number from 0 to 2 for each cube of four voxels; file:
    /// from a .vdb file.
    enum class Pattern { uniform, layered, random, file };
    Pattern pattern = Pattern::uniform;
    double p4 = 0;            ///< %, mass of fines over that of ballast and fines, in [0, 100)
    double p200 = 0;          ///< %, of that mass, finer than 0.075 mm; at most p4
    double low = 0, high = 1; ///< of the layer, as shares of the height of the ballast
    double saturation = 0;    ///< of the voids that the fines leave, in [0, 1]
    std::uint64_t seed = 1;
    /// For Pattern::file: the grid `fines` (kg/m3) replaces p4, and the grid `saturation`, if
    /// present, replaces saturation.
    std::filesystem::path file = {};
};

/// Fills the empty fields of a scene (add_fouling). Fines lie between the lowest and the highest
/// rock. Throws InputError if values are out of range, if the voids cannot hold the fines, or if
/// the file lacks a grid or does not cover the rocks; OutputError if it cannot be read.
void fill_with_fines(World& world, const InitialFouling& initial);

} // namespace bris
