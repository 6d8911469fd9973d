#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/edges.hpp"

namespace bris {

/// Linear springs with dashpots, friction that falls with the normal force, and a couple of edges.
struct LinearEdges : EdgeLaw<LinearNormal> {
    static constexpr LawName id = LawName::linear_edges;
    static constexpr auto name = "linear_edges";
    static constexpr auto summary = "Linear springs with dashpots, friction that falls with the "
                                    "normal force, and a couple of edges with a strength.";
    static constexpr bool has_edges = true;
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness),
        coefficients::shear_stiffness,
        coefficients::friction,
        coefficients::restitution,
        coefficients::normal_damping,
        coefficients::shear_damping,
        coefficients::rolling_friction,
        coefficients::twisting_friction,
        coefficients::friction_rise,
        coefficients::friction_half_force,
        coefficients::couple_arm,
        coefficients::couple_force};
};

} // namespace bris
