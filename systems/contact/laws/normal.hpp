#pragma once

#include "systems/contact/laws/law.hpp"

namespace bris {

// Normal pieces: elastic force and tangent stiffnesses, on all lanes at once.

/// f = kn * overlap; springs of constant stiffness (Cundall and Strack 1979).
struct LinearNormal {
    static constexpr double exponent = 1; ///< of the overlap in the force
    static constexpr double damping_onset =
        1; ///< mean over last damping coefficient while an overlap grows from zero
    static constexpr bool varying =
        false; ///< whether the tangential stiffness changes with the overlap
    static StiffnessLanes stiffness(const ContactLanes& c, const CoefficientLanes& k) {
        return {k.kn * c.overlap, k.kn, k.ks};
    }
};

/// f = 4/3 E* a overlap with the contact radius a = sqrt(R* overlap) (Hertz 1882); tangent
/// stiffnesses 2 E* a and, without slip, 8 G* a (Mindlin 1949).
struct HertzNormal {
    static constexpr double exponent = 1.5;
    static constexpr double damping_onset =
        0.8; // that of Tsuji goes with the fourth root of the overlap
    static constexpr bool varying = true;
    static StiffnessLanes stiffness(const ContactLanes& c, const CoefficientLanes& k) {
        const Lane a = sqrt(c.radius * c.overlap), normal = 2.0 * k.kn * a;
        return {2.0 / 3 * normal * c.overlap, normal, 2.0 * k.ks * a};
    }
};

} // namespace bris
