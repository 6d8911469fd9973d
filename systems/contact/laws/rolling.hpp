#pragma once

#include "systems/contact/laws/tangential.hpp"

namespace bris {

struct NoRolling {
    static constexpr bool present = false;
};

/// Resistance to rolling and to twisting: two springs with their own limits and histories, each elastic-plastic,
/// with a dashpot while it sticks (model C of Ai, Chen, Rotter and Ooi 2011; Luding 2008). Stretches are
/// displacements of surfaces: rolling moves by R* (w x n), twisting by R* (w . n). Torque limits are
/// rolling_friction and twisting_friction times R* times normal force.
struct RollingSprings {
    static constexpr bool present = true;

    static void torque(const ContactLanes& c, const RollingLanes& k, const LawStep& step, const StiffnessLanes& stiffness,
                       Lane kept, RollLanes& roll, ForceLanes& f) {
        turn_with_pair(c, step.dt, roll.x, roll.y, roll.z);
        const Lane ks = k.stiffness_ratio * stiffness.shear, radius = c.radius, force = max(f.normal, lanes(0));
        const Lane dashpot = 2.0 * k.damping_ratio * sqrt(ks / c.inverse_mass);
        const Lane vx = radius * (c.wy * c.nz - c.wz * c.ny), vy = radius * (c.wz * c.nx - c.wx * c.nz),
                   vz = radius * (c.wx * c.ny - c.wy * c.nx), vt = radius * (c.wx * c.nx + c.wy * c.ny + c.wz * c.nz);
        const double dt = step.dt;
        const RollLanes old{kept * roll.x, kept * roll.y, kept * roll.z, kept * roll.twist};
        RollLanes now{old.x + dt * vx, old.y + dt * vy, old.z + dt * vz, old.twist + dt * vt};
        const RollLanes trial = now;

        const Lane limit = k.rolling_friction * force, size = ks * sqrt(now.x * now.x + now.y * now.y + now.z * now.z);
        const LaneMask rolls = size > limit, twists = ks * magnitude(now.twist) > k.twisting_friction * force;
        const Lane cut = rolls ? limit / size : lanes(1), sticking = rolls ? lanes(0) : dashpot;
        now.x *= cut;
        now.y *= cut;
        now.z *= cut;
        const Lane twist_limit = k.twisting_friction * force / (ks > 0.0 ? ks : lanes(1));
        now.twist = twists ? (now.twist < 0.0 ? -twist_limit : twist_limit) : now.twist;
        const Lane twist_dashpot = twists ? lanes(0) : (k.twisting_friction > 0.0 ? dashpot : lanes(0));
        const Lane rolling_dashpot = k.rolling_friction > 0.0 ? sticking : lanes(0);

        const Lane fx = -ks * now.x - rolling_dashpot * vx, fy = -ks * now.y - rolling_dashpot * vy,
                   fz = -ks * now.z - rolling_dashpot * vz, ft = -ks * now.twist - twist_dashpot * vt;
        f.torque_x = radius * (c.ny * fz - c.nz * fy + ft * c.nx);
        f.torque_y = radius * (c.nz * fx - c.nx * fz + ft * c.ny);
        f.torque_z = radius * (c.nx * fy - c.ny * fx + ft * c.nz);
        if (step.book) {
            const auto slid = [&](Lane o, Lane t, Lane n) { return 0.5 * ks * (o + n) * (t - n); };
            f.work.rolling = slid(old.x, trial.x, now.x) + slid(old.y, trial.y, now.y) + slid(old.z, trial.z, now.z) +
                             slid(old.twist, trial.twist, now.twist) +
                             dt * (rolling_dashpot * (vx * vx + vy * vy + vz * vz) + twist_dashpot * vt * vt);
        }
        roll = now;
    }

private:
    static Lane magnitude(Lane a) { return a < 0.0 ? -a : a; }
};

} // namespace bris
