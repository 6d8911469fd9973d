#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// Linear springs with Coulomb friction, dashpots, and resistance to rolling and twisting.
struct LinearRolling : Law<LinearNormal, Dashpots, CoulombSpring, RollingSprings> {
    static constexpr LawName id = LawName::linear_rolling;
    static constexpr auto name = "linear_rolling";
    static constexpr auto summary =
        "Linear springs with Coulomb friction, dashpots, and resistance to rolling and twisting.";
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness),
        coefficients::shear_stiffness,
        coefficients::friction,
        coefficients::restitution,
        coefficients::normal_damping,
        coefficients::shear_damping,
        coefficients::rolling_friction,
        coefficients::twisting_friction};
};

} // namespace bris
