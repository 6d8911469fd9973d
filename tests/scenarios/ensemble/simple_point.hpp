#pragma once

#include "scenarios/ensemble/model_run.hpp"

#include <algorithm>
#include <cmath>

namespace bris::testing {

/// Adds a stage of a minimal model: q from friction and stiffness, and from a perturbation `push`
/// that grows over 0.5 % of strain.
inline void add_simple_stage(TestCurves& curves, const RockParameters& rocks, double strain,
                             double push) {
    const auto p = curves.add_row();
    const double stiff = 1e8 * rocks.stiffness * strain,
                 strong = 4e5 * std::pow(rocks.friction, 0.8) *
                          (1 + push * std::min(1.0, strain / 5e-3));
    p[quantity::axial_strain] = strain;
    p[quantity::deviatoric_stress] = stiff * strong / (stiff + strong);
    p[quantity::volumetric_strain] = 0;
    for (std::size_t r = 0; r < 8; ++r) p.part(quantity::ring_radius, r) = 0.1;
}

} // namespace bris::testing
