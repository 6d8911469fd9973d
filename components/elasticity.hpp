#pragma once

#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <cmath>
#include <span>
#include <type_traits>

namespace bris {

/// Tangent stiffnesses of one contact (N/m) and the energy of its normal spring (J).
struct Elasticity {
    double normal, shear, energy;
};

/// Elasticity of a contact at this overlap (m). `radius`: effective radius R* (m), used by Hertz
/// only.
inline Elasticity elasticity(const LawRow& k, bool hertz, double overlap, double radius) {
    if (!hertz) return {k.kn, k.ks, 0.5 * k.kn * overlap * overlap};
    const double a = std::sqrt(radius * overlap), normal = 2 * k.kn * a;
    return {normal, 2 * k.ks * a, 4.0 / 15 * normal * overlap * overlap};
}

/// Effective radius of a near pair, m: 1 / (1/r1 + 1/r2) for two spheres, r for a sphere and a
/// boundary.
template <class Pairs>
double effective_radius(const NearEntry& near, std::span<const SphereRow> sphere_row) {
    const double a = sphere_row[near.owner].radius;
    if constexpr (!std::is_same_v<Pairs, SpherePairs>)
        return a;
    else
        return a * sphere_row[near.other].radius / (a + sphere_row[near.other].radius);
}

} // namespace bris
