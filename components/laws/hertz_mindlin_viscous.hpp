#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// Hertz and Mindlin with Coulomb friction and dashpots.
struct HertzMindlinViscous : Law<HertzNormal, Dashpots, CoulombSpring> {
    static constexpr LawName id = LawName::hertz_mindlin_viscous;
    static constexpr auto name = "hertz_mindlin_viscous";
    static constexpr auto summary = "Hertz and Mindlin with Coulomb friction and dashpots.";
    static constexpr std::array of_materials{coefficients::above_zero(coefficients::young_modulus),
                                             coefficients::poisson_ratio,
                                             coefficients::friction,
                                             coefficients::restitution,
                                             coefficients::normal_damping,
                                             coefficients::shear_damping};
};

} // namespace bris
