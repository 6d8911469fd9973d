#pragma once

#include <filesystem>

namespace bris {

/// A number with its 90 % band.
struct NumberWithBand {
    double value = 0, low = 0, high = 0;
};

/// Properties of the rocks of a test, as estimated from it (material_card).
struct MaterialCard {
    NumberWithBand friction;        ///< between rocks
    NumberWithBand clump_stiffness; ///< N/m, of a rock as one of two partners
    NumberWithBand core_porosity;   ///< of the specimen, at the start of shearing
};

/// Writes a card as CSV: one row with nine columns such as friction, friction_low, friction_high.
/// Throws OutputError.
void write_material_card(const std::filesystem::path& csv, const MaterialCard& card);

/// Reads a card. Throws InputError with file:line, what was expected and what was found, and
/// OutputError.
MaterialCard read_material_card(const std::filesystem::path& csv);

} // namespace bris
