#pragma once

#include "components/laws/lanes.hpp"

namespace bris {

struct Frictionless {
    static constexpr bool has_history = false;
};

/// Share of the last step during which the surfaces touched. A new spring begins when the surfaces
/// meet, not at the beginning of the step.
inline Lane share_of_step(const ContactLanes& c, LaneMask fresh, double dt) {
    const Lane gone = c.closing * dt;
    const LaneMask within = fresh & (gone > c.overlap);
    return bits(within) == 0 ? lanes(1) : within ? c.overlap / gone : lanes(1);
}

/// sqrt(1 + x). Contacts turn little in a step, so a series with an error of 1e-16 is enough except
/// for fast rotations.
inline Lane root_near_one(Lane x) {
    const Lane series = 1.0 + x * (0.5 - x * (0.125 - x * (0.0625 - 0.0390625 * x)));
    const LaneMask far = x * x > 1e-8;
    return bits(far) == 0 ? series
           // chosen per lane, so that a result does not depend on the other lanes of the tile
           : far ? sqrt(1.0 + x)
                 : series;
}

/// Rotates a stretch with its pair: projects it onto the new tangent plane, keeps its length, and
/// rotates it about the normal with the mean angular velocity.
inline void turn_with_pair(const ContactLanes& c, double dt, Lane& x, Lane& y, Lane& z) {
    const Lane sn = x * c.nx + y * c.ny + z * c.nz;
    const Lane sx = x - sn * c.nx, sy = y - sn * c.ny, sz = z - sn * c.nz;
    const Lane angle = c.twist * dt;
    const Lane rx = sx + angle * (c.ny * sz - c.nz * sy), ry = sy + angle * (c.nz * sx - c.nx * sz),
               rz = sz + angle * (c.nx * sy - c.ny * sx);
    const Lane was = x * x + y * y + z * z, is = rx * rx + ry * ry + rz * rz;
    const Lane scale = is > 0.0 ? root_near_one((was - is) / is) : is;
    x = scale * rx;
    y = scale * ry;
    z = scale * rz;
}

/// Tangential spring with Coulomb's limit. There is no friction under tension and no dashpot while
/// the contact slides. The spring is stretched by the displacement of the leapfrog in the last
/// step; with velocities predicted from the last acceleration, its oscillations would grow by
/// (omega dt)^4 / 8 per step. Where the stiffness varies (Mindlin), the force follows it as
/// ShearHistory says, with the mean stiffness of each step. Order of accuracy: second in dt.
struct CoulombSpring {
    static constexpr bool has_history = true;

    template <class Normal, class Damping>
    [[gnu::always_inline]] static void force(const ContactLanes& c, const CoefficientLanes& k,
                                             const LawStep& step, const StiffnessLanes& stiffness,
                                             const DashpotLanes& rates, SpringLanes& spring,
                                             ForceLanes& f) {
        const Lane un = c.ux * c.nx + c.uy * c.ny + c.uz * c.nz;
        const LaneMask fresh = spring.stiffness == 0.0;
        const Lane share = share_of_step(c, fresh, step.dt) * step.dt;
        const Lane dx = share * (c.ux - un * c.nx), dy = share * (c.uy - un * c.ny),
                   dz = share * (c.uz - un * c.nz);

        SpringLanes old = spring;
        turn_with_pair(c, step.dt, old.x, old.y, old.z);
        Lane kept = lanes(1), moved = lanes(1);
        const bool varying = Normal::varying || step.shared;
        if (varying) {
            const Lane ratio =
                stiffness.shear > 0.0 ? spring.stiffness / stiffness.shear : lanes(0);
            kept = min(max(ratio, lanes(step.least_ratio)), lanes(step.largest_ratio));
            moved = Normal::varying ? 0.5 * (1.0 + kept) : (fresh ? lanes(1) : 0.5 * (1.0 + kept));
        }
        const SpringLanes trial{kept * old.x + moved * dx, kept * old.y + moved * dy,
                                kept * old.z + moved * dz, stiffness.shear};
        spring = trial;
        if (!varying) spring.stiffness = lanes(1);

        const Lane limit = k.friction * max(f.normal, lanes(0)),
                   size2 = stiffness.shear * stiffness.shear * squared(trial);
        const LaneMask slides = size2 > limit * limit;
        if (bits(slides) != 0) { // shortens the stretch to that of the largest friction force
            const Lane ratio = slides ? limit / sqrt(size2) : lanes(1);
            spring.x *= ratio;
            spring.y *= ratio;
            spring.z *= ratio;
        }
        Lane gx = -stiffness.shear * spring.x, gy = -stiffness.shear * spring.y,
             gz = -stiffness.shear * spring.z;
        Lane viscous{};
        if constexpr (Damping::present) {
            const Lane vn = c.vx * c.nx + c.vy * c.ny + c.vz * c.nz;
            const Lane tx = c.vx - vn * c.nx, ty = c.vy - vn * c.ny, tz = c.vz - vn * c.nz,
                       speed2 = tx * tx + ty * ty + tz * tz;
            Lane dashpot = slides ? lanes(0) : rates.shear;
            // the dashpot may add only what Coulomb's limit leaves: |g - d t| = limit
            const Lane push = dashpot * (gx * tx + gy * ty + gz * tz),
                       size = dashpot * dashpot * speed2;
            const Lane room = limit * limit - (gx * gx + gy * gy + gz * gz);
            const LaneMask capped = (size - 2.0 * push > room) & (size > 0.0);
            if (bits(capped) != 0)
                dashpot =
                    capped
                        ? dashpot * (push + sqrt(push * push + size * max(room, lanes(0)))) / size
                        : dashpot;
            gx -= dashpot * tx;
            gy -= dashpot * ty;
            gz -= dashpot * tz;
            viscous = step.dt * dashpot * speed2;
        }
        if (step.accumulate_work) {
            f.work.friction = sliding_work(stiffness.shear, kept, old, trial, spring);
            // a pair that separates in the next step loses the energy of its stretch
            const LaneMask parts = -c.closing * step.dt > c.overlap;
            f.work.friction += parts ? 0.5 * stiffness.shear * squared(spring) : lanes(0);
            if (varying)
                f.work.friction +=
                    k.friction > 0.0 ? work_of_change(stiffness.shear, kept, old, trial) : lanes(0);
            f.work.viscous += viscous;
        }
        f.x += gx;
        f.y += gy;
        f.z += gz;
    }

    static Lane squared(const SpringLanes& s) { return s.x * s.x + s.y * s.y + s.z * s.z; }

    /// Work (J) of sliding: the sliding distance times the mean of the spring's force before and
    /// after the step, or times the force after it if the force reversed within the step. Never
    /// negative.
    static Lane sliding_work(Lane k, Lane kept, const SpringLanes& old, const SpringLanes& trial,
                             const SpringLanes& now) {
        const Lane sx = trial.x - now.x, sy = trial.y - now.y, sz = trial.z - now.z;
        const Lane before = kept * (old.x * sx + old.y * sy + old.z * sz),
                   after = now.x * sx + now.y * sy + now.z * sz;
        return k * max(after, lanes(0)) + (before > -after ? 0.5 * k * (before - after) : lanes(0));
    }

    /// Energy (J) that the spring loses when its stiffness changes: at constant force while it
    /// grows, at constant stretch while it shrinks. Negative for a history that is not passive.
    static Lane work_of_change(Lane k, Lane kept, const SpringLanes& old,
                               const SpringLanes& trial) {
        const Lane was = squared(old), is = squared(trial), mean = 0.5 * (old.stiffness + k);
        const Lane by_stretch = 0.25 * (old.stiffness - k) * (was + is);
        const Lane by_force = 0.5 * k * is * (k / mean - 1.0) +
                              0.5 * old.stiffness * was * (1.0 - old.stiffness / mean);
        return mean > 0.0 ? (kept == 1.0 ? by_stretch : by_force) : lanes(0);
    }
};

} // namespace bris
