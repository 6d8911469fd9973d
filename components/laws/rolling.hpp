#pragma once

#include "components/laws/tangential.hpp"

namespace bris {

struct NoRolling {
    static constexpr bool present = false;
    static double arm_of(const EdgeRow&, double) { return 0; }
};

/// The effective radius R* as the arm of the couple, and a limit in proportion to the force.
struct RadiusArm {
    [[gnu::always_inline]] static Lane arm(const ContactLanes& c, const CoefficientLanes&) {
        return c.radius;
    }
    [[gnu::always_inline]] static Lane force(const CoefficientLanes&, Lane normal) {
        return normal;
    }
    /// Whether no contact of the tile has a couple.
    static bool is_absent(const CoefficientLanes&) { return false; }
    static double arm_of(const EdgeRow&, double radius) { return radius; }
};

/// Resistance to rolling and to twisting by two elastic-plastic springs with their own limits and
/// histories, each with a dashpot while it sticks (model C of Ai, Chen, Rotter and Ooi 2011; Luding
/// 2008). The stretches (m) are displacements at the rates l (w x n) for rolling and l (w . n) for
/// twisting, with the arm l, usually R*. The torque limits are rolling_friction and
/// twisting_friction times the arm times a force, usually the normal force.
template <class Arm>
struct RollingSpringsOf {
    static constexpr bool present = true;
    /// Arm (m) of the couple of a contact of that effective radius (m).
    static double arm_of(const EdgeRow& edges, double radius) { return Arm::arm_of(edges, radius); }

    [[gnu::always_inline]] static void torque(const ContactLanes& c,
                                              const CoefficientLanes& coefficients,
                                              const RollingLanes& k, const LawStep& step,
                                              Lane shear_stiffness, Lane old_shear_stiffness,
                                              RollLanes& roll, ForceLanes& f) {
        if (Arm::is_absent(coefficients)) return;
        SpringLanes old{roll.x, roll.y, roll.z, k.stiffness_ratio * old_shear_stiffness};
        turn_with_pair(c, step.dt, old.x, old.y, old.z);
        const Lane ks = k.stiffness_ratio * shear_stiffness, radius = Arm::arm(c, coefficients),
                   force = Arm::force(coefficients, max(f.normal, lanes(0)));
        // The spring keeps its force while the stiffness grows, and its stretch while the stiffness
        // shrinks; so it never creates energy.
        const Lane kept = ks > 0.0 ? min(old.stiffness / ks, lanes(1)) : lanes(0),
                   dt = 0.5 * (1.0 + kept) * step.dt;
        const Lane vx = radius * (c.wy * c.nz - c.wz * c.ny),
                   vy = radius * (c.wz * c.nx - c.wx * c.nz),
                   vz = radius * (c.wx * c.ny - c.wy * c.nx),
                   vt = radius * (c.wx * c.nx + c.wy * c.ny + c.wz * c.nz);
        const SpringLanes trial{kept * old.x + dt * vx, kept * old.y + dt * vy,
                                kept * old.z + dt * vz, ks};
        const SpringLanes old_twist{roll.twist, Lane{}, Lane{}, old.stiffness},
            trial_twist{kept * roll.twist + dt * vt, Lane{}, Lane{}, ks};

        const Lane limit = k.rolling_friction * force,
                   size = ks * sqrt(trial.x * trial.x + trial.y * trial.y + trial.z * trial.z);
        const LaneMask rolls = size > limit;
        const Lane cut = rolls ? limit / size : lanes(1);
        const SpringLanes now{cut * trial.x, cut * trial.y, cut * trial.z, ks};
        const Lane twist_limit = k.twisting_friction * force,
                   twisted = ks * magnitude(trial_twist.x);
        const LaneMask twists = twisted > twist_limit;
        const SpringLanes twist{twists ? trial_twist.x * (twist_limit / twisted) : trial_twist.x,
                                Lane{}, Lane{}, ks};

        const Lane dashpot = 2.0 * k.damping_ratio * sqrt(ks / c.inverse_mass);
        const Lane rolling_dashpot = rolls ? lanes(0) : dashpot,
                   twist_dashpot = twists ? lanes(0) : dashpot;
        const Lane fx = -ks * now.x - rolling_dashpot * vx, fy = -ks * now.y - rolling_dashpot * vy,
                   fz = -ks * now.z - rolling_dashpot * vz, ft = -ks * twist.x - twist_dashpot * vt;
        f.torque_x = radius * (c.ny * fz - c.nz * fy + ft * c.nx);
        f.torque_y = radius * (c.nz * fx - c.nx * fz + ft * c.ny);
        f.torque_z = radius * (c.nx * fy - c.ny * fx + ft * c.nz);
        if (step.accumulate_work) {
            const SpringLanes gone{step.dt * vx, step.dt * vy, step.dt * vz, Lane{}},
                twisted_by{step.dt * vt, Lane{}, Lane{}, Lane{}};
            f.work.rolling =
                CoulombSpring::work_of_step(old.stiffness, ks, kept, old, gone, trial, now) +
                CoulombSpring::work_of_step(old.stiffness, ks, kept, old_twist, twisted_by,
                                            trial_twist, twist) +
                step.dt *
                    (rolling_dashpot * (vx * vx + vy * vy + vz * vz) + twist_dashpot * vt * vt);
        }
        roll = {now.x, now.y, now.z, twist.x};
    }

    /// Work (J) of a contact that has ended in the last step, as CoulombSpring::work_of_separation.
    /// `shear_stiffness`: N/m, one step ago.
    static Lane work_of_separation(const ContactLanes& c, const CoefficientLanes& coefficients,
                                   const RollingLanes& k, const LawStep& step, Lane shear_stiffness,
                                   const RollLanes& roll) {
        Lane x = roll.x, y = roll.y, z = roll.z;
        turn_with_pair(c, step.dt, x, y, z);
        const Lane along = x * (c.wy * c.nz - c.wz * c.ny) + y * (c.wz * c.nx - c.wx * c.nz) +
                           z * (c.wx * c.ny - c.wy * c.nx),
                   twisting = roll.twist * (c.wx * c.nx + c.wy * c.ny + c.wz * c.nz);
        const auto released = [&](Lane stretch2, Lane rate) {
            return max(stretch2 + step.dt * Arm::arm(c, coefficients) * rate, lanes(0));
        };
        return 0.5 * k.stiffness_ratio * shear_stiffness *
               (released(x * x + y * y + z * z, along) +
                released(roll.twist * roll.twist, twisting));
    }
};
using RollingSprings = RollingSpringsOf<RadiusArm>;

} // namespace bris
