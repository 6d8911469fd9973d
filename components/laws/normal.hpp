#pragma once

#include "components/elasticity.hpp"
#include "components/laws/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

// Normal parts of a law: elastic force and tangent stiffnesses, for all lanes at once, and for a
// single contact together with its energy. Each part names the table of coefficients that it reads
// and the quantities kn and ks.

/// Linear springs of constant stiffness: f = kn * overlap (Cundall and Strack 1979).
struct LinearNormal {
    static constexpr double exponent = 1; ///< of the overlap in the force
    /// Whether the tangential stiffness changes with the overlap.
    static constexpr bool varying = false;
    static constexpr auto normal_name = "stiffness of a contact",
                          shear_name = "shear stiffness of a contact", unit = "N/m";

    static const std::vector<LawRow>& rows(const Materials& m) { return m.linear_pairs; }
    static StiffnessLanes stiffness(const ContactLanes& c, const CoefficientLanes& k) {
        return {k.kn * c.overlap, k.kn, k.ks};
    }
    /// Share of the dashpot's force in the first step of a contact, which has lasted for the
    /// fraction `part` of a step, such that the sum over all steps equals the impulse.
    static Lane share_of_dashpot(Lane part) { return 0.5 + part; }
    static Elasticity elasticity(const LawRow& k, double overlap, double) {
        return {k.kn, k.ks, 0.5 * k.kn * overlap * overlap};
    }
    static double overlap_to_expect(const LawRow&, double, double, double) { return 0; }
};

/// Hertz contact: f = 4/3 E* a overlap with the contact radius a = sqrt(R* overlap) (Hertz 1882).
/// The tangent stiffnesses are 2 E* a and, without slip, 8 G* a (Mindlin 1949).
struct HertzNormal {
    static constexpr double exponent = 1.5;
    static constexpr bool varying = true;
    static constexpr auto normal_name = "effective modulus", shear_name = "effective shear modulus",
                          unit = "Pa";

    static const std::vector<LawRow>& rows(const Materials& m) { return m.hertz_pairs; }
    static StiffnessLanes stiffness(const ContactLanes& c, const CoefficientLanes& k) {
        const Lane a = sqrt(c.radius * c.overlap), normal = 2.0 * k.kn * a;
        return {2.0 / 3 * normal * c.overlap, normal, 2.0 * k.ks * a};
    }
    /// As LinearNormal::share_of_dashpot. The damping coefficient of Tsuji grows as overlap^(1/4).
    /// A sum of x^(1/4) at x = part, part + 1, ... differs from its integral by the Hurwitz zeta
    /// function zeta(-1/4, part) besides terms of the far end; the first term makes up for it, so
    /// that the error of the impulse is of second order in dt and not of order 1.25. The polynomial
    /// is -zeta(-1/4, 1 + part) to 2e-6.
    static Lane share_of_dashpot(Lane part) {
        constexpr std::array c{0.3204495277,  0.8604476965, 0.1824127442,
                               -0.0615075439, 0.0237398456, -0.0050920037};
        Lane sum = lanes(c.back());
        for (std::size_t i = c.size() - 1; i-- > 0;) sum = sum * part + c[i];
        return sum / sqrt(sqrt(max(part, lanes(1e-12))));
    }
    static Elasticity elasticity(const LawRow& k, double overlap, double radius) {
        const double a = std::sqrt(radius * overlap), normal = 2 * k.kn * a;
        return {normal, 2 * k.ks * a, 4.0 / 15 * normal * overlap * overlap};
    }
    /// Largest overlap in the impact of two equal bodies, at least half a percent of the radius:
    /// contacts at rest overlap more only under loads that an estimate from the touching contacts
    /// includes.
    static double overlap_to_expect(const LawRow& k, double mass, double radius, double speed) {
        const double coefficient = 4.0 / 3 * k.kn * std::sqrt(radius);
        return std::max(0.005 * radius,
                        std::pow(5 * mass * speed * speed / (4 * coefficient), 0.4));
    }
};

} // namespace bris
