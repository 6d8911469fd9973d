#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

#include <cmath>
#include <numbers>

namespace bris {

/// Liquid between surfaces of two materials, the same for every pair of surfaces that touches.
struct LiquidBridge {
    double surface_tension = 0; ///< N/m, >= 0
    double contact_angle = 0;   ///< rad, from 0 to 50 degrees
    double volume = 0;          ///< m3, >= 0, liquid in one bridge; 0: no bridge

    OwnCoefficients coefficients() const { return {surface_tension, contact_angle, volume}; }
};

/// Linear springs with Coulomb friction, dashpots and a liquid bridge, whose force is the closed
/// form of Willett, Adams, Johnson and Seville (2000), Langmuir 16:9396, eqs. (12) and (13),
///     F = 2 pi R gamma cos(theta) / (1 + 2.1 s + 10 s^2),   s = (S / 2) / sqrt(V / R),
/// with the separation S of the surfaces, the liquid volume V and the effective radius of Derjaguin
/// R, which is 2 R1 R2 / (R1 + R2) for unequal spheres and 2 R1 for a sphere and a plane. The form
/// is meant for small bridges. For perfect wetting and V up to 0.001 R^3 it lies within 8 % of the
/// longer fit in the paper's appendix over the first third of the range of S, and is a fifth weaker
/// than that fit at rupture; at a contact angle of 40 degrees it is half as strong there. The
/// attraction of surfaces that overlap is that at S = 0.
///
/// A bridge forms when the surfaces first touch, not on approach, and ruptures at
/// S = (1 + theta / 2) V^(1/3) (Lian, Thornton and Adams 1993). The history of the tangential
/// spring records that a bridge exists. The liquid of a grain is not conserved: it limits neither
/// the volume nor the number of the grain's bridges. Each sphere of a clump has its own bridges,
/// and a membrane has none. Coulomb's limit uses the normal force between the solids, without the
/// attraction of the bridge.
///
/// Energy: the potential of F, zero at rupture, counts as elastic energy. When a bridge forms, the
/// potential falls at once by the work W that F does between touch and rupture. The spreading
/// liquid dissipates this energy, so W counts as viscous work. A contact that forms and separates
/// therefore loses W, and no energy is lost at rupture.
struct LinearBridge : Law<LinearNormal, Dashpots, CoulombSpring> {
    using Dry = Law<LinearNormal, Dashpots, CoulombSpring>;

    static constexpr LawName id = LawName::linear_bridge;
    static constexpr auto name = "linear_bridge";
    static constexpr auto summary =
        "Linear springs with Coulomb friction, dashpots and liquid bridges, which attract grains "
        "until they rupture.";
    static constexpr std::array of_materials{
        coefficients::above_zero(coefficients::normal_stiffness),
        coefficients::shear_stiffness,
        coefficients::friction,
        coefficients::restitution,
        coefficients::normal_damping,
        coefficients::shear_damping};
    static constexpr std::array of_pairs{
        Coefficient{.name = "surface tension", .unit = "N/m"},
        Coefficient{.name = "contact angle", .unit = "rad", .high = 50 * std::numbers::pi / 180},
        Coefficient{.name = "volume of a liquid bridge", .unit = "m3"}};
    static constexpr bool has_reach = true;

    // Indices of OwnRow::value.
    enum : std::size_t {
        wetting, ///< N/m, 2 pi gamma cos(theta)
        volume,  ///< m3
        rupture  ///< m
    };

    static OwnRow own_row(const OwnCoefficients& c) {
        const auto [surface_tension, contact_angle, liquid, unused] = c;
        return {{2 * std::numbers::pi * surface_tension * std::cos(contact_angle), liquid,
                 (1 + 0.5 * contact_angle) * std::cbrt(liquid), 0}};
    }
    static double reach(const OwnRow& row, double) { return row.value[rupture]; }
    static double potential(const OwnRow& row, double overlap, double radius) {
        const double inside = std::max(overlap, 0.0);
        return -work_to_rupture(row, std::max(-overlap, 0.0), radius) -
               (row.value[volume] > 0 ? row.value[wetting] * 2 * radius * inside : 0);
    }

    /// Work (J) of the bridge's force from a gap between the surfaces (m) to rupture, in closed
    /// form. `radius` (m) is 1 / (1/R1 + 1/R2), half of Derjaguin's effective radius.
    static double work_to_rupture(const OwnRow& row, double gap, double radius) {
        if (!(row.value[volume] > 0) || gap >= row.value[rupture]) return 0;
        const double derjaguin = 2 * radius, length = std::sqrt(row.value[volume] / derjaguin),
                     root = std::sqrt(4 * second - first * first);
        const auto integral = [&](double distance) {
            return 2 / root * std::atan((second * distance / length + first) / root);
        };
        return row.value[wetting] * derjaguin * 2 * length *
               (integral(row.value[rupture]) - integral(gap));
    }

    static ForceLanes force(ContactLanes& c, const CoefficientLanes& k, const OwnLanes& own,
                            const RollingLanes& rolling, const LawStep& step, SpringLanes& spring,
                            RollLanes& roll) {
        const LaneMask touches = c.overlap > 0.0, forms = spring.stiffness == 0.0,
                       solids = touches | (spring.stiffness > 0.0); // touch, or have just parted
        SpringLanes begun = spring; // between surfaces that are apart it has not begun yet
        begun.stiffness = max(spring.stiffness, lanes(0));
        ForceLanes f = Dry::force(c, k, rolling, step, begun, roll);
        for (Lane* part : {&f.x, &f.y, &f.z, &f.normal, &f.work.friction, &f.work.viscous})
            *part = solids ? *part : lanes(0);
        spring = {touches ? begun.x : lanes(0), touches ? begun.y : lanes(0),
                  touches ? begun.z : lanes(0), touches ? begun.stiffness : lanes(held_apart)};
        const Lane pull = pull_of(c, own, step, forms);
        f.normal -= pull;
        f.x -= pull * c.nx;
        f.y -= pull * c.ny;
        f.z -= pull * c.nz;
        if (step.accumulate_work) f.work.viscous += spent_on_forming(c, own, forms);
        return f;
    }

private:
    static constexpr double first = 2.1, second = 10; ///< eq. (12)
    /// Stiffness that marks the spring of a bridge between surfaces that are apart.
    static constexpr double held_apart = -1;

    /// Attractive force of the bridge, N. A bridge that forms or ruptures within a step acts for a
    /// part of the step only (PartialStep).
    static Lane pull_of(const ContactLanes& c, const OwnLanes& own, const LawStep& step,
                        LaneMask forms) {
        const Lane radius = 2.0 * c.radius, gap = max(-c.overlap, lanes(0));
        const Lane s = 0.5 * gap * sqrt(radius / own.value[volume]);
        const Lane whole = own.value[wetting] * radius / (1.0 + s * (first + second * s));
        const Lane way = c.closing * step.dt, left = own.value[rupture] - gap;
        const LaneMask begins = forms & (way > c.overlap), ends = -way > left;
        const Lane share =
            begins ? 0.5 + max(c.overlap, lanes(0)) / way : (ends ? 0.5 - left / way : lanes(1));
        return own.value[volume] > 0.0 ? share * whole : lanes(0);
    }

    /// Energy (J) dissipated by the bridges that form in this step.
    static Lane spent_on_forming(const ContactLanes& c, const OwnLanes& own, LaneMask forms) {
        Lane work{};
        if (bits(forms) == 0) return work;
        for (std::size_t q = 0; q < lane_count; ++q)
            work[q] = work_to_rupture(
                {{own.value[wetting][q], own.value[volume][q], own.value[rupture][q], 0}}, 0,
                c.radius[q]);
        return forms ? work : lanes(0);
    }
};

} // namespace bris
