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

/// How much of a dashpot's force counts in a step within which the contact begins or ends. The force of a step acts from
/// half a step before it to half a step after, and a dashpot sets in at once where surfaces meet at a speed: without this,
/// restitution is of first order in dt. `onset`: mean of the coefficient between meeting and now, over that of now.
inline Lane share_of_kick(const ContactLanes& c, LaneMask fresh, Lane opening, double onset, double dt) {
    const Lane came = c.closing * dt, goes = opening * dt;
    const Lane begin = (fresh & (came > c.overlap)) ? 0.5 + onset * c.overlap / came : lanes(1);
    const Lane end = goes > c.overlap ? 0.5 + onset * c.overlap / goes : lanes(1);
    return begin * end;
}

} // namespace bris
