#pragma once

#include "components/laws/damping.hpp"
#include "components/laws/normal.hpp"
#include "components/laws/partial_step.hpp"
#include "components/laws/rolling.hpp"
#include "components/laws/tangential.hpp"

namespace bris {

/// Contact law composed of a normal spring, dashpots, a tangential part and a rolling part, so that
/// no code is copied between laws. A named law derives from it and adds what LawTraits needs: id,
/// name, summary and coefficients.
template <class NormalPart, class Damping, class Tangential, class Rolling = NoRolling>
struct Law {
    using Normal = NormalPart;
    using DampingPart = Damping;
    using RollingPart = Rolling;
    static constexpr bool has_history = Tangential::has_history;
    static constexpr bool has_dashpots = Damping::present;
    static constexpr bool has_rolling = Rolling::present;

    // Redefined by a law that reads the edges of materials (EdgeRow), or whose edges wear.

    static constexpr bool has_edges = false;
    /// Pairs have a radius `worn`, which `force` takes.
    static constexpr bool has_wear = false;

    // Redefined by a law that acts beyond touch or has its own coefficients for pairs of materials.

    /// With reach, `overlap` is negative where the surfaces are apart, and `force` takes OwnLanes.
    static constexpr bool has_reach = false;
    static constexpr std::array<Coefficient, 0> of_pairs{};
    static OwnRow own_row(const OwnCoefficients&) { return {}; }
    static double reach(const OwnRow&, double) { return 0; }
    static double potential(const OwnRow&, double, double) { return 0; }

    /// Whether the force of a contact that has ended is corrected in the step after
    /// (CorrectionOfEnd). The tangential spring records that the pair touched.
    static constexpr bool corrects_end = has_history && has_dashpots;

    /// Computes the force and torque on the owner and advances the springs by one step. Pairs that
    /// have separated in the last step are included with corrects_end, or if the energy budget
    /// needs the work that their springs lose; their overlap is negative. Inline with all that
    /// happens in most steps, so that the numbers of a contact stay in registers; for the same
    /// reason `c` is no copy, but is as before afterwards.
    [[gnu::always_inline]] static ForceLanes force(ContactLanes& c, const CoefficientLanes& k,
                                                   const RollingLanes& rolling, const LawStep& step,
                                                   SpringLanes& spring, RollLanes& roll) {
        LaneMask ended{};
        WorkLanes lost;
        if constexpr (has_history) {
            if (corrects_end || step.accumulate_work) ended = ended_ones(c, spring);
            if (bits(ended) != 0) lost = work_of_separation(c, k, rolling, step, spring, roll);
        }
        const Lane overlap = c.overlap;
        c.overlap = max(overlap, lanes(0)); // rounding may leave it below zero where surfaces touch
        ForceLanes f = force_of_touching(c, k, rolling, step, spring, roll);
        c.overlap = overlap;
        if constexpr (has_history)
            if (bits(ended) != 0) {
                if constexpr (corrects_end) {
                    const Ended after = end(c, k, step, ended, f, spring, roll);
                    f = after.force;
                    spring = after.spring;
                    roll = after.roll;
                }
                f.work.friction = ended ? lost.friction : f.work.friction;
                f.work.rolling = ended ? lost.rolling : f.work.rolling;
            }
        return f;
    }

private:
    /// Contacts that have ended in the last step.
    static LaneMask ended_ones(const ContactLanes& c, const SpringLanes& spring) {
        return (c.overlap <= 0.0) & (spring.stiffness > 0.0);
    }

    [[gnu::always_inline]] static ForceLanes
    force_of_touching(const ContactLanes& c, const CoefficientLanes& k, const RollingLanes& rolling,
                      const LawStep& step, SpringLanes& spring, RollLanes& roll) {
        const StiffnessLanes stiffness = stiffness_of(c, k, step);
        ForceLanes f;
        const DashpotLanes dashpots = Damping::coefficients(c, k, stiffness);
        f.normal = normal_force(c, k, step, stiffness, dashpots, f.work);
        f.x = f.normal * c.nx;
        f.y = f.normal * c.ny;
        f.z = f.normal * c.nz;
        if constexpr (has_rolling) {
            const bool varying = Normal::varying || step.shared;
            Rolling::torque(c, k, rolling, step, stiffness.shear,
                            varying ? spring.stiffness : stiffness.shear, roll, f);
        }
        if constexpr (has_history)
            Tangential::template force<Normal, Damping>(c, k, step, stiffness, dashpots, spring, f);
        if constexpr (has_history && Normal::varying) {
            // a contact without stiffness, where rounding has left no overlap, has no history: new
            // lists would not keep it
            const LaneMask open = spring.stiffness == 0.0;
            if (bits(open) != 0)
                for (Lane* stretch :
                     {&spring.x, &spring.y, &spring.z, &roll.x, &roll.y, &roll.z, &roll.twist})
                    *stretch = open ? lanes(0) : *stretch;
        }
        return f;
    }

    static StiffnessLanes stiffness_of(const ContactLanes& c, const CoefficientLanes& k,
                                       const LawStep& step) {
        const StiffnessLanes s = Normal::stiffness(c, k);
        return step.shared
                   ? StiffnessLanes{c.share * s.force, c.share * s.normal, c.share * s.shear}
                   : s;
    }

    /// Work that the springs of contacts lose that have ended in the last step. Called rarely: a
    /// function of its own, with copies, so that the springs may stay in registers elsewhere.
    [[gnu::noinline]] static WorkLanes work_of_separation(ContactLanes c, CoefficientLanes k,
                                                          RollingLanes rolling, LawStep step,
                                                          SpringLanes spring, RollLanes roll) {
        WorkLanes lost;
        if (!step.accumulate_work) return lost;
        const bool varying = Normal::varying || step.shared;
        const Lane stiffness = varying ? spring.stiffness : k.ks;
        lost.friction = Tangential::work_of_separation(c, step, stiffness, spring);
        if constexpr (has_rolling)
            lost.rolling = Rolling::work_of_separation(c, k, rolling, step, stiffness, roll);
        return lost;
    }

    struct Ended {
        ForceLanes force;
        SpringLanes spring;
        RollLanes roll;
    };
    /// Replaces the forces of the contacts that have ended by their corrections, and clears their
    /// springs. Called rarely, as work_of_separation.
    [[gnu::noinline]] static Ended end(ContactLanes c, CoefficientLanes k, LawStep step,
                                       LaneMask ended, ForceLanes f, SpringLanes spring,
                                       RollLanes roll) {
        Lane force = lanes(0), viscous = lanes(0);
        if (!step.shared) { // shares are those of touching pairs: the end of a patch is predicted
            const CorrectionOfEnd last(c, step.dt);
            const StiffnessLanes stiffness = stiffness_of(last.before, k, step);
            const Lane dashpot = Damping::coefficients(last.before, k, stiffness).normal,
                       elastic = last.template elastic<Normal>(k);
            force =
                last.template force<Normal>(stiffness.force, elastic, dashpot, step.least_force);
            const Lane separation = 0.5 * step.dt * c.inverse_mass * force - c.closing;
            viscous = step.dt * separation * (elastic - stiffness.force - force);
        }
        const auto replace = [&](Lane& value, Lane by) { value = ended ? by : value; };
        replace(f.normal, force);
        replace(f.x, force * c.nx);
        replace(f.y, force * c.ny);
        replace(f.z, force * c.nz);
        replace(f.work.viscous, viscous);
        for (Lane* none : {&f.torque_x, &f.torque_y, &f.torque_z, &spring.x, &spring.y, &spring.z,
                           &spring.stiffness, &roll.x, &roll.y, &roll.z, &roll.twist})
            replace(*none, lanes(0));
        return {f, spring, roll};
    }

    [[gnu::always_inline]] static Lane normal_force(const ContactLanes& c,
                                                    const CoefficientLanes& k, const LawStep& step,
                                                    const StiffnessLanes& stiffness,
                                                    const DashpotLanes& dashpots, WorkLanes& work) {
        const PartialStep partial(c, step.dt, !corrects_end || step.shared);
        Lane elastic = stiffness.force, share = lanes(1);
        if (partial.any()) {
            elastic = partial.template elastic<Normal>(c, k, elastic);
            share = partial.template dashpot<Normal>(c);
        }
        if constexpr (!has_dashpots)
            return elastic;
        else {
            const Lane vn = c.vx * c.nx + c.vy * c.ny + c.vz * c.nz;
            const Lane dashpot = share * dashpots.normal,
                       force = max(elastic - dashpot * vn, lanes(step.least_force));
            if (step.accumulate_work) {
                // The mean velocity of the step differs from the predicted one, because the force
                // changes, or sets in, during the step.
                const Lane later = 0.5 * step.dt * c.inverse_mass;
                const Lane change =
                    -step.dt * (stiffness.normal * vn + dashpot * c.inverse_mass * force);
                work.viscous = max(step.dt * (vn + later * (partial.begins ? force : change)) *
                                       (elastic - force),
                                   lanes(0));
            }
            return force;
        }
    }
};

} // namespace bris
