#pragma once

#include "components/pair.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/laws/damping.hpp"
#include "systems/contact/laws/normal.hpp"
#include "systems/contact/laws/partial_step.hpp"
#include "systems/contact/laws/rolling.hpp"
#include "systems/contact/laws/tangential.hpp"

namespace bris {

/// A law is composed, never copied: normal spring, dashpots, tangential part, rolling part.
template <class NormalPart, class Damping, class Tangential, class Rolling = NoRolling>
struct Law {
    using Normal = NormalPart;
    static constexpr bool has_history = Tangential::has_history;
    static constexpr bool has_dashpots = Damping::present;
    static constexpr bool has_rolling = Rolling::present;

    /// Force and torque on the owner; moves the springs on by one step.
    static ForceLanes force(const ContactLanes& c, const CoefficientLanes& k,
                            const RollingLanes& rolling, const LawStep& step, SpringLanes& spring,
                            RollLanes& roll) {
        StiffnessLanes stiffness = Normal::stiffness(c, k);
        if (step.shared)
            stiffness = {c.share * stiffness.force, c.share * stiffness.normal,
                         c.share * stiffness.shear};
        ForceLanes f{};
        const DashpotLanes dashpots = Damping::coefficients(c, k, stiffness);
        f.normal = normal_force(c, k, step, stiffness, dashpots, f.work);
        f.x = f.normal * c.nx;
        f.y = f.normal * c.ny;
        f.z = f.normal * c.nz;
        if constexpr (has_rolling) {
            const bool varying = Normal::varying || step.shared;
            Rolling::torque(c, rolling, step, stiffness.shear,
                            varying ? spring.stiffness : stiffness.shear, roll, f);
        }
        if constexpr (has_history)
            Tangential::template force<Normal, Damping>(c, k, step, stiffness, dashpots, spring, f);
        return f;
    }

private:
    static Lane normal_force(const ContactLanes& c, const CoefficientLanes& k, const LawStep& step,
                             const StiffnessLanes& stiffness, const DashpotLanes& dashpots,
                             WorkLanes& work) {
        const PartialStep partial(c, step.dt);
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
                // the mean velocity of the step is not the predicted one: the force changes
                // meanwhile, or sets in
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

using LinearFrictionless = Law<LinearNormal, NoDamping, Frictionless>;
using Linear = Law<LinearNormal, NoDamping, CoulombSpring>;
using LinearViscous = Law<LinearNormal, Dashpots, CoulombSpring>;
using LinearRolling = Law<LinearNormal, Dashpots, CoulombSpring, RollingSprings>;
using HertzFrictionless = Law<HertzNormal, NoDamping, Frictionless>;
using HertzMindlin = Law<HertzNormal, NoDamping, CoulombSpring>;
using HertzMindlinViscous = Law<HertzNormal, Dashpots, CoulombSpring>;
using HertzMindlinRolling = Law<HertzNormal, Dashpots, CoulombSpring, RollingSprings>;

template <class...>
struct Columns {};

/// Calls make.template operator()<Law, columns of near rows, columns of pairs>() with the law of
/// that name and the columns that it writes besides the record of force.
template <class... Share, class Make>
auto with_law_and_share(LawName law, bool energy_budget, Make&& make) {
    using Springs = Columns<Spring>;
    using Rolls = Columns<Spring, Roll>;
    const auto sliding = [&]<class L>() {
        return energy_budget ? make.template operator()<L, Columns<PairWork, Share...>, Springs>()
                             : make.template operator()<L, Columns<Share...>, Springs>();
    };
    const auto rolling = [&]<class L>() {
        return energy_budget
                   ? make.template operator()<L, Columns<PairTorque, PairWork, Share...>, Rolls>()
                   : make.template operator()<L, Columns<PairTorque, Share...>, Rolls>();
    };
    switch (law) {
    case LawName::linear_frictionless:
        break;
    case LawName::linear:
        return sliding.template operator()<Linear>();
    case LawName::linear_viscous:
        return sliding.template operator()<LinearViscous>();
    case LawName::linear_rolling:
        return rolling.template operator()<LinearRolling>();
    case LawName::hertz_frictionless:
        return make.template operator()<HertzFrictionless, Columns<Share...>, Columns<>>();
    case LawName::hertz_mindlin:
        return sliding.template operator()<HertzMindlin>();
    case LawName::hertz_mindlin_viscous:
        return sliding.template operator()<HertzMindlinViscous>();
    case LawName::hertz_mindlin_rolling:
        return rolling.template operator()<HertzMindlinRolling>();
    }
    return make.template operator()<LinearFrictionless, Columns<Share...>, Columns<>>();
}
template <class Make>
auto with_law(LawName law, const StepChoices& choices, Make&& make) {
    return choices.patch == PatchStiffness::shared
               ? with_law_and_share<const PatchShare>(law, choices.energy_budget, make)
               : with_law_and_share<>(law, choices.energy_budget, make);
}

} // namespace bris
