#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// Hertz and Mindlin with Coulomb friction, dashpots, and resistance to rolling and twisting.
struct HertzMindlinRolling : Law<HertzNormal, Dashpots, CoulombSpring, RollingSprings> {
    static constexpr LawName id = LawName::hertz_mindlin_rolling;
    static constexpr auto name = "hertz_mindlin_rolling";
    static constexpr auto summary = "Hertz and Mindlin with Coulomb friction, dashpots, and "
                                    "resistance to rolling and twisting.";
    static constexpr std::array of_materials{coefficients::above_zero(coefficients::young_modulus),
                                             coefficients::poisson_ratio,
                                             coefficients::friction,
                                             coefficients::restitution,
                                             coefficients::normal_damping,
                                             coefficients::shear_damping,
                                             coefficients::rolling_friction,
                                             coefficients::twisting_friction};
};

} // namespace bris
