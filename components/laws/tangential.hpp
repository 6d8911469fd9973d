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
[[gnu::always_inline]] inline void turn_with_pair(const ContactLanes& c, double dt, Lane& x,
                                                  Lane& y, Lane& z) {
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

/// Coulomb's limit with a constant coefficient.
struct ConstantFriction {
    template <class Normal>
    [[gnu::always_inline]] static Lane limit(const ContactLanes&, const CoefficientLanes& k,
                                             Lane normal) {
        return k.friction * normal;
    }
};

/// Tangential spring with Coulomb's limit. There is no friction under tension and no dashpot while
/// the contact slides. The spring is stretched by the displacement of the leapfrog in the last
/// step; with velocities predicted from the last acceleration, its oscillations would grow by
/// (omega dt)^4 / 8 per step. Where the stiffness varies (Mindlin), the force follows it as
/// ShearHistory says, with the mean stiffness of each step. Order of accuracy: second in dt.
template <class Friction>
struct CoulombSpringOf {
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
        const Lane spring_before = spring.stiffness;
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

        const Lane limit = Friction::template limit<Normal>(c, k, max(f.normal, lanes(0))),
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
            f.work.friction =
                work_of_step(varying ? spring_before : stiffness.shear, stiffness.shear, kept, old,
                             {dx, dy, dz, Lane{}}, trial, spring);
            f.work.viscous += viscous;
        }
        f.x += gx;
        f.y += gy;
        f.z += gz;
    }

    static Lane squared(const SpringLanes& s) { return s.x * s.x + s.y * s.y + s.z * s.z; }

    static Lane product(const SpringLanes& a, const SpringLanes& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }

    /// Work (J) that a spring takes from the motion in a step and does not store: by sliding, and
    /// by a change of its stiffness. The leapfrog moves the bodies by `gone` (m) between two
    /// instants, and the kicks before and after do the work of the mean of the forces at both
    /// (trapezoidal rule, exact for the leapfrog). `k_old`, `old`: stiffness and stretch before the
    /// step; `k`, `now`: after it; `trial`: the stretch without Coulomb's limit; `kept`: share of
    /// the old stretch kept when the stiffness changed. If the force reversed within the step, the
    /// trapezoidal rule fails, and the work is at least the force after it times the sliding
    /// distance. Never negative but for a history that is not passive (ShearHistory).
    static Lane work_of_step(Lane k_old, Lane k, Lane kept, const SpringLanes& old,
                             const SpringLanes& gone, const SpringLanes& trial,
                             const SpringLanes& now) {
        const Lane work = 0.5 * (k_old * (product(old, gone) + squared(old)) +
                                 k * (product(now, gone) - squared(now)));
        const SpringLanes slip{trial.x - now.x, trial.y - now.y, trial.z - now.z, Lane{}};
        const Lane after = product(now, slip);
        const LaneMask reversed = kept * product(old, slip) < -after,
                       passive = (kept < 1.0) | ((kept == 1.0) & (k <= k_old));
        const Lane least = max(reversed ? k * after : lanes(0), lanes(0));
        return passive ? max(work, least) : work;
    }

    /// Work (J) of a contact that has ended in the last step: the energy of its spring and the work
    /// that the spring's last force does on the bodies in that step, which the leapfrog gives them
    /// half a step before and half a step after its instant (trapezoidal rule). Never negative.
    /// `stiffness`: of the spring one step ago.
    static Lane work_of_separation(const ContactLanes& c, const LawStep& step, Lane stiffness,
                                   SpringLanes old) {
        turn_with_pair(c, step.dt, old.x, old.y, old.z);
        const Lane un = c.ux * c.nx + c.uy * c.ny + c.uz * c.nz;
        const Lane along =
            old.x * (c.ux - un * c.nx) + old.y * (c.uy - un * c.ny) + old.z * (c.uz - un * c.nz);
        return 0.5 * stiffness * max(squared(old) + step.dt * along, lanes(0));
    }
};
using CoulombSpring = CoulombSpringOf<ConstantFriction>;

} // namespace bris
