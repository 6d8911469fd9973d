#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// Linear springs, normal and tangential, with Coulomb friction (Cundall and Strack 1979).
struct Linear : Law<LinearNormal, NoDamping, CoulombSpring> {
    static constexpr LawName id = LawName::linear;
    static constexpr auto name = "linear";
    static constexpr auto summary =
        "Linear springs, normal and tangential, with Coulomb friction (Cundall and Strack 1979).";
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness), coefficients::shear_stiffness,
        coefficients::friction};
};

} // namespace bris
