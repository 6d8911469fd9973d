#pragma once

#include "systems/contact/laws/law.hpp"

namespace bris {

// Pieces of the linear law. Each works on all lanes at once and without branches.

/// Normal spring: f = kn * overlap (Cundall and Strack 1979).
struct LinearNormal {
    static Lane force(const ContactLanes& c, const CoefficientLanes& k) { return k.kn * c.overlap; }
};

struct NoDamping {
    static constexpr bool present = false;
};

/// Dashpots of a rate times the reduced mass, in both directions. The normal force may pull at the
/// end of a contact (the "tension allowed" policy): restitution is then exp(-pi gamma / (2 omega_d))
/// with omega_d^2 = kn/m* - (gamma/2)^2, whatever the speed.
struct RateDamping {
    static constexpr bool present = true;
    static Lane coefficient(Lane rate, const ContactLanes& c) { return rate / c.inverse_mass; }
};

struct Frictionless {
    static constexpr bool has_history = false;
};

/// Tangential spring with Coulomb's limit. The spring is kept in the world frame; it is turned with
/// the pair (onto the new tangent plane at its old length, and about the normal with the mean
/// spin). Without dashpots it moves by the displacement of the last step. With dashpots, velocities
/// are of the time of the positions: the stored stretch then runs half a step ahead, and the force
/// uses it half a step back (trapezoidal rule). Both are second order in dt.
struct CoulombSpring {
    static constexpr bool has_history = true;

    template <class Damping>
    static void force(const ContactLanes& c, const CoefficientLanes& k, double dt, Lane normal_force,
                      SpringLanes& spring, ForceLanes& f) {
        const Lane vn = c.ux * c.nx + c.uy * c.ny + c.uz * c.nz;
        const Lane tx = c.ux - vn * c.nx, ty = c.uy - vn * c.ny, tz = c.uz - vn * c.nz;

        const Lane sn = spring.x * c.nx + spring.y * c.ny + spring.z * c.nz;
        Lane sx = spring.x - sn * c.nx, sy = spring.y - sn * c.ny, sz = spring.z - sn * c.nz;
        const Lane angle = c.twist * dt;
        const Lane rx = sx + angle * (c.ny * sz - c.nz * sy), ry = sy + angle * (c.nz * sx - c.nx * sz),
                   rz = sz + angle * (c.nx * sy - c.ny * sx);
        const Lane was = spring.x * spring.x + spring.y * spring.y + spring.z * spring.z;
        const Lane is = rx * rx + ry * ry + rz * rz;
        const Lane scale = is > 0.0 ? sqrt(was / is) : is;
        const double before = Damping::present ? 0.5 * dt : dt, after = dt - before;
        const Lane ox = scale * rx, oy = scale * ry, oz = scale * rz;
        sx = ox + before * tx;
        sy = oy + before * ty;
        sz = oz + before * tz;

        Lane gx = -k.ks * sx, gy = -k.ks * sy, gz = -k.ks * sz;
        Lane dashpot = normal_force - normal_force;
        if constexpr (Damping::present) {
            dashpot = Damping::coefficient(k.shear_damping, c);
            gx -= dashpot * tx;
            gy -= dashpot * ty;
            gz -= dashpot * tz;
        }
        const Lane limit = k.friction * (normal_force < 0.0 ? -normal_force : normal_force);
        const Lane g2 = gx * gx + gy * gy + gz * gz;
        const LaneMask slips = g2 > limit * limit;
        if (bits(slips) != 0) {
            const Lane ratio = slips ? limit / sqrt(g2) : lanes(1);
            gx *= ratio;
            gy *= ratio;
            gz *= ratio;
            // the spring that carries what friction can, if there is a spring
            const LaneMask reset = slips & (k.ks > 0.0);
            const Lane inverse = lanes(1) / (reset ? k.ks : lanes(1));
            const Lane was_x = sx, was_y = sy, was_z = sz;
            sx = reset ? -(gx + dashpot * tx) * inverse : sx;
            sy = reset ? -(gy + dashpot * ty) * inverse : sy;
            sz = reset ? -(gz + dashpot * tz) * inverse : sz;
            // the slid distance, against the mean of the spring's force before and after the step
            f.slip_work = 0.5 * ((gx - k.ks * ox) * (sx - was_x) + (gy - k.ks * oy) * (sy - was_y) +
                                 (gz - k.ks * oz) * (sz - was_z));
        }
        spring.x = sx + after * tx;
        spring.y = sy + after * ty;
        spring.z = sz + after * tz;
        f.x += gx;
        f.y += gy;
        f.z += gz;
    }
};

/// A law is composed, never copied: normal spring, dashpots, tangential part.
template <class Normal, class Damping, class Tangential> struct Law {
    static constexpr bool has_history = Tangential::has_history;
    static constexpr bool damped = Damping::present;

    /// Force on the owner; moves the spring on by one step.
    static ForceLanes force(const ContactLanes& c, const CoefficientLanes& k, double dt,
                            SpringLanes& spring) {
        Lane normal = Normal::force(c, k);
        if constexpr (Damping::present) {
            const Lane vn = c.ux * c.nx + c.uy * c.ny + c.uz * c.nz;
            normal -= Damping::coefficient(k.normal_damping, c) * vn;
        }
        ForceLanes f{normal * c.nx, normal * c.ny, normal * c.nz, normal, normal - normal};
        if constexpr (has_history) Tangential::template force<Damping>(c, k, dt, normal, spring, f);
        return f;
    }
};

using Linear = Law<LinearNormal, NoDamping, CoulombSpring>;
using LinearFrictionless = Law<LinearNormal, NoDamping, Frictionless>;
using LinearViscous = Law<LinearNormal, RateDamping, CoulombSpring>;
using LinearViscousFrictionless = Law<LinearNormal, RateDamping, Frictionless>;

} // namespace bris
