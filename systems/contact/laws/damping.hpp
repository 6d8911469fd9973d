#pragma once

#include "systems/contact/laws/law.hpp"

namespace bris {

struct NoDamping {
    static constexpr bool present = false;
};

/// Dashpots on both springs: a rate times the reduced mass, and a ratio of critical damping of the tangent
/// stiffness. With the latter, restitution does not depend on speed, neither for linear springs nor for Hertz's
/// (Tsuji, Tanaka and Ishida 1992). A share of a patch has that share of its dashpot. N s/m.
struct Dashpots {
    static constexpr bool present = true;
    static Lane normal(const ContactLanes& c, const CoefficientLanes& k, const StiffnessLanes& s) {
        const Lane mass = c.share / c.inverse_mass;
        return k.normal_rate * mass + k.normal_ratio * sqrt(s.normal * mass);
    }
    static Lane shear(const ContactLanes& c, const CoefficientLanes& k, const StiffnessLanes& s) {
        const Lane mass = c.share / c.inverse_mass;
        return k.shear_rate * mass + k.shear_ratio * sqrt(s.shear * mass);
    }
};

} // namespace bris
