#pragma once

#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <span>
#include <type_traits>

namespace bris {

/// Tangent stiffnesses of one contact (N/m) and the energy of its normal spring (J).
struct Elasticity {
    double normal, shear, energy;
};

/// Elasticity of a contact of a row of coefficients. `radius`: m, effective; `worn`: m, radius of
/// its edge, or Worn::never for a pair without edges.
Elasticity elasticity_of(const LawTraits& law, const Materials& materials, Row row, double overlap,
                         double radius, double worn);

/// Effective radius (m) of a near pair: 1 / (1/r1 + 1/r2) for two spheres, r for a sphere and a
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
