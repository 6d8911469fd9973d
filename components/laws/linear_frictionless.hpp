#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

namespace bris {

/// A linear normal spring alone.
struct LinearFrictionless : Law<LinearNormal, NoDamping, Frictionless> {
    static constexpr LawName id = LawName::linear_frictionless;
    static constexpr auto name = "linear_frictionless";
    static constexpr auto summary = "A linear normal spring alone.";
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness)};
};

} // namespace bris
