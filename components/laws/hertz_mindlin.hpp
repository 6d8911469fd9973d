#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// The normal force of Hertz and the tangential spring of Mindlin with Coulomb friction.
struct HertzMindlin : Law<HertzNormal, NoDamping, CoulombSpring> {
    static constexpr LawName id = LawName::hertz_mindlin;
    static constexpr auto name = "hertz_mindlin";
    static constexpr auto summary =
        "The normal force of Hertz and the tangential spring of Mindlin with Coulomb friction.";
    static constexpr std::array of_materials{coefficients::above_zero(coefficients::young_modulus),
                                             coefficients::poisson_ratio, coefficients::friction};
};

} // namespace bris
