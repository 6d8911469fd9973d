#pragma once

#include "components/laws/lanes.hpp"

namespace bris {

struct NoDamping {
    static constexpr bool present = false;
    static DashpotLanes coefficients(const ContactLanes&, const CoefficientLanes&,
                                     const StiffnessLanes&) {
        return {};
    }
};

/// Dashpots on both springs: a rate times the reduced mass, and a ratio of critical damping of the
/// tangent stiffness. With the latter, restitution does not depend on speed, neither for linear
/// springs nor for Hertz's (Tsuji, Tanaka and Ishida 1992). A share of a patch has that share of
/// its dashpot.
struct Dashpots {
    static constexpr bool present = true;
    static DashpotLanes coefficients(const ContactLanes& c, const CoefficientLanes& k,
                                     const StiffnessLanes& s) {
        const Lane mass = c.share / c.inverse_mass;
        DashpotLanes d{k.normal_rate * mass, k.shear_rate * mass};
        if (bits(k.normal_ratio > 0.0) == 0) return d;
        const Lane root = sqrt(s.normal * mass);
        return {d.normal + k.normal_ratio * root, d.shear + k.shear_ratio * root};
    }
};

} // namespace bris
