#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/composed.hpp"

#include <cmath>
#include <numbers>

namespace bris {

/// Liquid between two surfaces of a pair of materials, the same for every pair that touches.
struct LiquidBridge {
    double surface_tension = 0; ///< N/m, >= 0
    double contact_angle = 0;   ///< rad, from 0 to 50 degrees
    double volume = 0;          ///< m3, >= 0, of one bridge; 0: no bridge

    OwnCoefficients coefficients() const { return {surface_tension, contact_angle, volume}; }
};

/// Linear springs with Coulomb friction and dashpots, and a liquid bridge: the closed form of
/// Willett, Adams, Johnson and Seville (2000), Langmuir 16:9396, eqs. (12) and (13),
///     F = 2 pi R gamma cos(theta) / (1 + 2.1 s + 10 s^2),   s = (S / 2) / sqrt(V / R),
/// with the distance S of the surfaces, the volume V and the effective radius of Derjaguin
/// R = 2 R1 R2 / (R1 + R2) of unequal spheres, 2 R1 of a sphere and a plane. It is meant for small
/// bridges. For perfect wetting and V up to 0.001 R^3 it lies within 8 % of the longer fit in the
/// paper's appendix over the nearer third of the range, and is a fifth weaker at rupture; at a
/// contact angle of 40 degrees it is half as strong there. Surfaces that overlap are pulled as at
/// S = 0.
///
/// A bridge forms when the surfaces first touch, not on approach, and ruptures at
/// S = (1 + theta / 2) V^(1/3) (Lian, Thornton and Adams 1993). The spring's history tells that it
/// exists. Neither the volume nor the number of bridges of a grain is limited by its liquid. Each
/// sphere of a clump has bridges of its own, and a membrane has none. Coulomb's limit is that of
/// the force between the solids, without the pull.
///
/// Energy: the potential is that of F, zero at rupture, and counts as elastic energy. Where a
/// bridge forms, its potential falls at once by the work W of pulling the surfaces from touch to
/// rupture; liquid that spreads dissipates this, so W counts as viscous work. Of a touch and a
/// separation thus W is lost, and nothing at rupture.
struct LinearBridge : Law<LinearNormal, Dashpots, CoulombSpring> {
    using Dry = Law<LinearNormal, Dashpots, CoulombSpring>;

    static constexpr LawName id = LawName::linear_bridge;
    static constexpr auto name = "linear_bridge";
    static constexpr auto summary =
        "Linear springs with Coulomb friction, dashpots, and liquid bridges that hold grains up to "
        "a distance.";
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

    // of OwnRow
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

    /// Work (J) of the bridge's force from a distance of the surfaces (m) to rupture, in closed
    /// form. `radius`: 1 / (1/R1 + 1/R2), half of Derjaguin's.
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

    static ForceLanes force(const ContactLanes& c, const CoefficientLanes& k, const OwnLanes& own,
                            const RollingLanes& rolling, const LawStep& step, SpringLanes& spring,
                            RollLanes& roll) {
        const LaneMask touches = c.overlap > 0.0, forms = spring.stiffness == 0.0;
        ContactLanes closed = c;
        closed.overlap = max(c.overlap, lanes(0));
        SpringLanes begun = spring; // of surfaces that are apart it has yet to begin
        begun.stiffness = max(spring.stiffness, lanes(0));
        ForceLanes f = Dry::force(closed, k, rolling, step, begun, roll);
        for (Lane* part : {&f.x, &f.y, &f.z, &f.normal, &f.work.friction, &f.work.viscous})
            *part = touches ? *part : lanes(0);
        spring = {touches ? begun.x : lanes(0), touches ? begun.y : lanes(0),
                  touches ? begun.z : lanes(0), touches ? begun.stiffness : lanes(held_apart)};
        const Lane pull = nudging_of(c, own, step, forms);
        f.normal -= pull;
        f.x -= pull * c.nx;
        f.y -= pull * c.ny;
        f.z -= pull * c.nz;
        if (step.accumulate_work) f.work.viscous += spent_on_forming(c, own, forms);
        return f;
    }

private:
    static constexpr double first = 2.1, second = 10; ///< eq. (12)
    static constexpr double held_apart = -1; ///< stiffness of a spring that has yet to begin

    /// Force of the bridge, N. Where it forms or ruptures within a step it acts for a part of the
    /// step only (PartialStep).
    static Lane nudging_of(const ContactLanes& c, const OwnLanes& own, const LawStep& step,
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
