#pragma once

#include "components/laws/coefficients.hpp"
#include "components/laws/edges.hpp"

namespace bris {

/// Hertz and Mindlin with conical damage, dashpots, friction that falls with the pressure, and a
/// couple of edges. The tangential spring is that of the blunted contact: kt = 8 G* sqrt(R u). Each
/// part is absent where its coefficients are zero.
struct HertzEdges : EdgeLaw<HertzNormal> {
    using Elastic = EdgeLaw<HertzNormal>;

    static constexpr LawName id = LawName::hertz_edges;
    static constexpr auto name = "hertz_edges";
    static constexpr auto summary =
        "Hertz and Mindlin with conical damage, dashpots, friction that falls with the pressure, "
        "and a couple of edges with a strength.";
    static constexpr bool has_edges = true, has_wear = true;
    static constexpr std::array of_materials{coefficients::above_zero(coefficients::young_modulus),
                                             coefficients::poisson_ratio,
                                             coefficients::friction,
                                             coefficients::restitution,
                                             coefficients::normal_damping,
                                             coefficients::shear_damping,
                                             coefficients::rolling_friction,
                                             coefficients::twisting_friction,
                                             coefficients::contact_strength,
                                             coefficients::cone_half_angle,
                                             coefficients::edge_radius,
                                             coefficients::friction_rise,
                                             coefficients::friction_half_pressure,
                                             coefficients::couple_arm,
                                             coefficients::couple_force};

    /// As Law::force, for the contact that stands for the blunted one. `worn`: radius of the edge,
    /// m, 0 while it has not yielded; it lasts as long as the surfaces overlap.
    [[gnu::always_inline]] static ForceLanes force(ContactLanes& c, const CoefficientLanes& k,
                                                   const RollingLanes& rolling, const LawStep& step,
                                                   SpringLanes& spring, RollLanes& roll,
                                                   Lane& worn) {
        const Lane overlap = c.overlap, radius = c.radius, closing = c.closing;
        const Lane tip = k.edges.radius > 0.0 ? k.edges.radius : radius, before = max(worn, tip);
        const Blunted<Lane> now = blunt(k.edges, max(overlap, lanes(0)), radius, worn);
        const LaneMask yields = now.radius > before;
        const LaneMask acts = (now.overlap > 0.0) | (spring.stiffness > 0.0); // or has just ended
        c.radius = now.radius;
        c.overlap = overlap > 0.0 ? now.overlap : overlap + (tip - before) * k.edges.blunting;
        if (bits(yields) != 0) {
            // the elastic overlap grows more slowly than that of the surfaces
            const Lane was = overlap - closing * step.dt + (tip - before) * k.edges.blunting;
            c.closing = yields ? (now.overlap - was) / step.dt : closing;
        }
        ForceLanes f = Elastic::force(c, k, rolling, step, spring, roll);
        if (bits(acts) != all_lanes)
            for (Lane* part : {&f.x, &f.y, &f.z, &f.normal, &f.torque_x, &f.torque_y, &f.torque_z,
                               &f.work.friction, &f.work.viscous, &f.work.rolling})
                *part = acts ? *part : lanes(0);
        if (step.accumulate_work)
            f.work.wear = c.share * energy_of_wear(k.edges, k.kn, before, now.radius);
        worn = ((overlap > 0.0) & (now.radius > tip)) ? now.radius : lanes(0);
        c.overlap = overlap;
        c.radius = radius;
        c.closing = closing;
        return f;
    }
};

} // namespace bris
