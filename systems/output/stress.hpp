#pragma once

#include "engine/world.hpp"

namespace bris {

/// Axial (z) and mean radial (x, y) components of a stress times the volume, J. Compression is
/// positive.
struct AxisymmetricStress {
    double axial = 0, radial = 0;
};

/// The stress of a specimen, computed twice: from contact forces times branch vectors (Love 1927,
/// Weber 1966), and from the external forces on the grains (boundaries, weight, nudging) times the
/// positions where they act. In equilibrium the two are equal.
struct Stresses {
    AxisymmetricStress contact, boundary;
    /// Stress mismatch: the larger relative difference of the axial and the radial component.
    /// Infinite where a boundary carries no load.
    double mismatch() const;
};
Stresses compute_stresses(const World& world);

} // namespace bris
