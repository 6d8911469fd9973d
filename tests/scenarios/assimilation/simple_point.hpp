#pragma once

#include "scenarios/assimilation/model_run.hpp"

#include <algorithm>
#include <cmath>

namespace bris::testing {

/// A stage of a minimal model: q from friction and stiffness, and from a perturbation `push` that
/// grows over 0.5 % of strain.
inline TriaxialPoint simple_point(const RockParameters& rocks, double strain, double push) {
    TriaxialPoint p;
    p.axial_strain = strain;
    const double stiff = 1e8 * rocks.stiffness * strain,
                 strong = 4e5 * std::pow(rocks.friction, 0.8) *
                          (1 + push * std::min(1.0, strain / 5e-3));
    p.deviatoric_stress = stiff * strong / (stiff + strong);
    p.ring_radius.assign(8, 0.1);
    return p;
}

} // namespace bris::testing
