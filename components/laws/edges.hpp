#pragma once

#include "components/laws/composed.hpp"

#include <numbers>

namespace bris {

// What the edges of a rock do at a contact: they yield and become blunt, their friction falls with
// the load, and they resist rolling and twisting by a couple. Coefficients: EdgeRow, as numbers of
// one contact or, in EdgeLanes, one contact per lane.

/// The elastic contact that stands for one whose edge has yielded: Hertz of this overlap and
/// radius, in m. Without overlap the surfaces still touch, but without force.
template <class Number>
struct Blunted {
    Number overlap, radius;
};

/// Conical damage (Harkness et al. 2016, Granular Matter 18; overlap as Suhr and Six 2017 read it).
/// An edge is a cone of half-angle a with a round tip of the radius R0. Where the largest contact
/// pressure of Hertz, 2 E* / pi sqrt(u / R), reaches the strength of the rock, the radius grows:
///     u = d + (R0 - R) f,  f = (1 - sin a) / sin a          elastic overlap
///     R = (d + R0 f) / (h^2 + f),  h = pi s / (2 E*)        while u > h^2 R
/// It is passive for h^2 < 5 f (damage_is_passive).
/// `overlap`: m, of the surfaces; `effective`: m, radius of two spheres, which counts as R0 where
/// the materials have none; `worn`: m, radius so far, 0 at first touch.
template <class Number, class Edges>
[[gnu::always_inline]] inline Blunted<Number> blunt(const Edges& e, Number overlap,
                                                    Number effective, Number worn) {
    const Number tip = e.radius > 0.0 ? e.radius : effective, before = worn > tip ? worn : tip;
    const Number opening = e.yield_ratio * e.yield_ratio,
                 elastic = overlap + (tip - before) * e.blunting;
    const auto yields = elastic > opening * before;
    const Number grown = (overlap + tip * e.blunting) / (opening + e.blunting);
    return {yields ? opening * grown : elastic, yields ? grown : before};
}

/// Energy (J) that an edge dissipates while its radius grows, in closed form. `modulus`: E*, Pa.
template <class Number, class Edges>
[[gnu::always_inline]] inline Number energy_of_wear(const Edges& e, Number modulus, Number before,
                                                    Number after) {
    const Number h = e.yield_ratio, grown = after > before ? h * after : h * before,
                 was = h * before;
    return modulus * (4.0 / 9 * e.blunting - 4.0 / 45 * h * h) *
           (grown * grown * grown - was * was * was);
}

/// Whether a contact that yields takes energy, and never gives it.
inline bool damage_is_passive(const EdgeRow& e) {
    return e.yield_ratio == EdgeRow::never_yields || e.yield_ratio * e.yield_ratio < 5 * e.blunting;
}

/// Coulomb's limit with a coefficient that falls with the load (Suhr and Six 2016, Powder
/// Technology 305): mu = mu0 + c1 / (1 + c2 p). The load p is the mean pressure of the contact for
/// Hertz, and the normal force for linear springs.
struct FallingFriction {
    template <class Normal>
    [[gnu::always_inline]] static Lane limit(const ContactLanes& c, const CoefficientLanes& k,
                                             Lane normal) {
        const Lane load = Normal::varying
                              ? k.edges.easing_pressure * normal /
                                    max(std::numbers::pi * c.radius * c.overlap, lanes(1e-300))
                              : k.edges.easing_force * normal;
        return (k.friction + k.edges.rise / (1.0 + load)) * normal;
    }
};

/// A couple with an arm of its own, of the size of a face, and a strength: its limits are
/// rolling_friction and twisting_friction times arm F / (1 + F / F1).
struct EdgeCouple {
    [[gnu::always_inline]] static Lane arm(const ContactLanes&, const CoefficientLanes& k) {
        return k.edges.arm;
    }
    [[gnu::always_inline]] static Lane force(const CoefficientLanes& k, Lane normal) {
        return normal / (1.0 + k.edges.couple_easing * normal);
    }
    static bool is_absent(const CoefficientLanes& k) { return bits(k.edges.arm > 0.0) == 0; }
    static double arm_of(const EdgeRow& e, double) { return e.arm; }
};

/// Dashpots, and the friction and the couple of edges, with a normal spring.
template <class NormalPart>
using EdgeLaw =
    Law<NormalPart, Dashpots, CoulombSpringOf<FallingFriction>, RollingSpringsOf<EdgeCouple>>;

} // namespace bris
