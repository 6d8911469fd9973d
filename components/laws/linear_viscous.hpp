#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// Linear springs with Coulomb friction and dashpots.
struct LinearViscous : Law<LinearNormal, Dashpots, CoulombSpring> {
    static constexpr LawName id = LawName::linear_viscous;
    static constexpr auto name = "linear_viscous";
    static constexpr auto summary = "Linear springs with Coulomb friction and dashpots.";
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness),
        coefficients::shear_stiffness,
        coefficients::friction,
        coefficients::restitution,
        coefficients::normal_damping,
        coefficients::shear_damping};
};

} // namespace bris
