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

/// Dashpots parallel to both springs. The damping coefficient is the sum of a rate times the
/// reduced mass and a ratio of critical damping at the tangent stiffness. With the ratio alone,
/// restitution does not depend on speed, for linear springs as well as for Hertz contacts (Tsuji,
/// Tanaka and Ishida 1992). A contact with a share of its patch's stiffness has the same share of
/// the dashpot.
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
