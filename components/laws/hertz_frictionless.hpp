#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// The normal force of Hertz alone.
struct HertzFrictionless : Law<HertzNormal, NoDamping, Frictionless> {
    static constexpr LawName id = LawName::hertz_frictionless;
    static constexpr auto name = "hertz_frictionless";
    static constexpr auto summary = "The normal force of Hertz alone.";
    static constexpr std::array of_materials{coefficients::above_zero(coefficients::young_modulus),
                                             coefficients::poisson_ratio};
};

} // namespace bris
