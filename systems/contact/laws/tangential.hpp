#pragma once

#include "systems/contact/laws/law.hpp"

namespace bris {

struct Frictionless {
    static constexpr bool has_history = false;
};

/// Share of the last step that a contact was closed: a spring begins when the surfaces meet, not with the step.
inline Lane share_of_step(const ContactLanes& c, LaneMask fresh, double dt) {
    const Lane gone = c.closing * dt;
    return (fresh & (gone > c.overlap)) ? c.overlap / gone : lanes(1);
}

/// Turns a stretch with its pair: onto the new tangent plane at its old length, and about the normal with the
/// mean spin.
inline void turn_with_pair(const ContactLanes& c, double dt, Lane& x, Lane& y, Lane& z) {
    const Lane sn = x * c.nx + y * c.ny + z * c.nz;
    const Lane sx = x - sn * c.nx, sy = y - sn * c.ny, sz = z - sn * c.nz;
    const Lane angle = c.twist * dt;
    const Lane rx = sx + angle * (c.ny * sz - c.nz * sy), ry = sy + angle * (c.nz * sx - c.nx * sz),
               rz = sz + angle * (c.nx * sy - c.ny * sx);
    const Lane was = x * x + y * y + z * z, is = rx * rx + ry * ry + rz * rz;
    const Lane scale = is > 0.0 ? sqrt(was / is) : is;
    x = scale * rx;
    y = scale * ry;
    z = scale * rz;
}

/// Tangential spring with Coulomb's limit; no friction under tension. The spring moves by the leapfrog's own
/// displacement of the last step: moved by velocities predicted from the last acceleration it would grow by
/// (omega dt)^4 / 8 a step. Where the stiffness varies (Mindlin), force follows it by ShearHistory, each step with
/// the mean stiffness: second order in dt.
struct CoulombSpring {
    static constexpr bool has_history = true;

    template <class Normal, class Damping>
    static void force(const ContactLanes& c, const CoefficientLanes& k, const LawStep& step, const StiffnessLanes& stiffness,
                      SpringLanes& spring, ForceLanes& f) {
        const Lane un = c.ux * c.nx + c.uy * c.ny + c.uz * c.nz;
        const LaneMask fresh = spring.stiffness == 0.0;
        const Lane share = share_of_step(c, fresh, step.dt) * step.dt;
        const Lane dx = share * (c.ux - un * c.nx), dy = share * (c.uy - un * c.ny), dz = share * (c.uz - un * c.nz);

        SpringLanes old = spring;
        turn_with_pair(c, step.dt, old.x, old.y, old.z);
        Lane kept = lanes(1), moved = lanes(1);
        const bool varying = Normal::varying || step.shared;
        if (varying) {
            const Lane ratio = stiffness.shear > 0.0 ? spring.stiffness / stiffness.shear : lanes(0);
            kept = min(max(ratio, lanes(step.least_ratio)), lanes(step.largest_ratio));
            moved = 0.5 * (1.0 + kept);
        }
        const SpringLanes trial{kept * old.x + moved * dx, kept * old.y + moved * dy, kept * old.z + moved * dz, stiffness.shear};
        spring = trial;
        if (!varying) spring.stiffness = lanes(1);

        Lane gx = -stiffness.shear * trial.x, gy = -stiffness.shear * trial.y, gz = -stiffness.shear * trial.z;
        Lane dashpot{}, tx{}, ty{}, tz{};
        if constexpr (Damping::present) {
            dashpot = Damping::shear(c, k, stiffness);
            const Lane vn = c.vx * c.nx + c.vy * c.ny + c.vz * c.nz;
            tx = c.vx - vn * c.nx;
            ty = c.vy - vn * c.ny;
            tz = c.vz - vn * c.nz;
            gx -= dashpot * tx;
            gy -= dashpot * ty;
            gz -= dashpot * tz;
        }
        const Lane limit = k.friction * max(f.normal, lanes(0));
        const Lane g2 = gx * gx + gy * gy + gz * gz;
        const LaneMask slips = g2 > limit * limit;
        if (bits(slips) != 0) {
            const Lane ratio = slips ? limit / sqrt(g2) : lanes(1);
            gx *= ratio;
            gy *= ratio;
            gz *= ratio;
            // the spring that carries what friction can, if there is a spring
            const LaneMask reset = slips & (stiffness.shear > 0.0);
            const Lane inverse = lanes(1) / (reset ? stiffness.shear : lanes(1));
            spring.x = reset ? -(gx + dashpot * tx) * inverse : spring.x;
            spring.y = reset ? -(gy + dashpot * ty) * inverse : spring.y;
            spring.z = reset ? -(gz + dashpot * tz) * inverse : spring.z;
        }
        if (step.book) {
            f.work.friction = sliding_work(stiffness.shear, kept, old, trial, spring);
            if (varying) f.work.friction += k.friction > 0.0 ? work_of_change(stiffness.shear, kept, old, trial) : lanes(0);
            if constexpr (Damping::present) f.work.viscous += step.dt * dashpot * (tx * tx + ty * ty + tz * tz);
        }
        f.x += gx;
        f.y += gy;
        f.z += gz;
    }

    /// The slid distance against the mean of the spring's force before and after; where the force turned round
    /// within the step, against the one after. Never negative.
    static Lane sliding_work(Lane k, Lane kept, const SpringLanes& old, const SpringLanes& trial, const SpringLanes& now) {
        const Lane sx = trial.x - now.x, sy = trial.y - now.y, sz = trial.z - now.z;
        const Lane before = kept * (old.x * sx + old.y * sy + old.z * sz), after = now.x * sx + now.y * sy + now.z * sz;
        return k * max(after, lanes(0)) + (before > -after ? 0.5 * k * (before - after) : lanes(0));
    }

    /// What the spring gives up where its stiffness changes: at constant force while it grows, at constant stretch
    /// while it shrinks. Negative for a history that is not passive.
    static Lane work_of_change(Lane k, Lane kept, const SpringLanes& old, const SpringLanes& trial) {
        const auto square = [](const SpringLanes& s) { return s.x * s.x + s.y * s.y + s.z * s.z; };
        const Lane was = square(old), is = square(trial), mean = 0.5 * (old.stiffness + k);
        const Lane by_stretch = 0.25 * (old.stiffness - k) * (was + is);
        const Lane by_force = 0.5 * k * is * (k / mean - 1.0) + 0.5 * old.stiffness * was * (1.0 - old.stiffness / mean);
        return mean > 0.0 ? (kept == 1.0 ? by_stretch : by_force) : lanes(0);
    }
};

} // namespace bris
