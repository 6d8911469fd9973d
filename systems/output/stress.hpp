#pragma once

#include "engine/world.hpp"

namespace bris {

/// Axial (z) and mean radial (x, y) part of a stress times the volume, J; compression is positive.
struct AxisymmetricStress {
    double axial = 0, radial = 0;
};

/// The stress of a specimen, twice: contact forces times branch vectors (Love 1927, Weber 1966),
/// and the forces on the grains from outside, of boundaries and weight, times their places. In
/// equilibrium both are the same.
struct Stresses {
    AxisymmetricStress contact, boundary;
    /// The larger relative difference of the two parts; infinite where a boundary carries nothing.
    double mismatch() const;
};
Stresses compute_stresses(const World& world);

} // namespace bris
