#pragma once

#include "systems/contact/sphere_surfaces.hpp"

namespace bris::detail {

/// Lever arms of two spheres that are bodies themselves: radius times `share`, along the normal, so
/// that the contact point divides the distance in proportion to the radii. The torque of the force
/// is then the same vector for both bodies, times their radius.
template <bool has_couple>
struct RadialArms {
    const ContactLanes& contact;
    const FourLanes &own, &partner; ///< rows of positions and radii, in m
    Lane share;                     ///< distance over the sum of the radii

    Vec3Lanes contact_point() const {
        const FourLanes b = transpose(partner);
        return Vec3Lanes{b[0], b[1], b[2]} + (b[3] * share) * normal();
    }
    [[gnu::always_inline]] UnitLanes units(const SumTarget& to, const ForceLanes& f) const {
        const Vec3Lanes force{f.x, f.y, f.z},
            per_radius = (to.per_torque * share) * cross(force, normal());
        Vec3Lanes of_own = transpose(own)[3] * per_radius,
                  of_partner = -transpose(partner)[3] * per_radius;
        if constexpr (has_couple) {
            const Vec3Lanes couple = to.per_torque * Vec3Lanes{f.torque_x, f.torque_y, f.torque_z};
            of_own = of_own + couple;
            of_partner = of_partner + couple;
        }
        return {to.per_force * force, of_own, of_partner};
    }

private:
    Vec3Lanes normal() const { return {contact.nx, contact.ny, contact.nz}; }
};

/// Contacts of spheres that are bodies themselves. Rows of both spheres are subtracted, or added
/// with the radii as factors, before they become lanes.
struct SingleSpheres : SphereSurfaces {
    template <class Law, SumsAt where>
    unsigned collide(const TileTarget& to, const Row* rows, int count) const {
        std::array<std::size_t, lane_count> own, other; // rows of bodies, which are slots
        for (std::size_t q = 0; q < lane_count; ++q) {
            own[q] = to.near[rows[q]].owner;
            other[q] = to.near[rows[q]].other;
        }
        const auto rows_of = [](const auto* table, const auto& bodies, auto member) {
            return load_rows(
                [&](int q) { return &(table[bodies[static_cast<std::size_t>(q)]].*member); });
        };
        const auto a = rows_of(movers.sphere_row, own, &SphereRow::x),
                   b = rows_of(movers.sphere_row, other, &SphereRow::x);
        const Lane sign = in_each_row(Quad{-1, -1, -1, 1});
        // differences of the first three numbers, and the sum of the fourth
        const auto relative = [&](const FourLanes& of_own, const FourLanes& of_other) {
            return transpose({of_own[0] + sign * of_other[0], of_own[1] + sign * of_other[1],
                              of_own[2] + sign * of_other[2], of_own[3] + sign * of_other[3]});
        };
        // r_a w_a + r_b w_b, from which the velocity of the surfaces follows
        const auto weighted = [&](const FourLanes& of_own, const FourLanes& of_other) {
            FourLanes sum;
            for (std::size_t q = 0; q < 4; ++q)
                sum[q] =
                    fourth_of_each_row(a[q]) * of_own[q] + fourth_of_each_row(b[q]) * of_other[q];
            return transpose(sum);
        };
        const auto [dx, dy, dz, reach] = relative(a, b);
        const auto [ux, uy, uz, inverse_mass] =
            relative(rows_of(movers.motion, own, &MotionRow::vx),
                     rows_of(movers.motion, other, &MotionRow::vx));
        const auto omega_a = rows_of(movers.motion, own, &MotionRow::omega_x),
                   omega_b = rows_of(movers.motion, other, &MotionRow::omega_x);
        const Lane distance = max(sqrt(dx * dx + dy * dy + dz * dz), lanes(1e-300));
        const Lane inverse = lanes(1) / distance, share = distance / reach;
        const Vec3Lanes u{ux, uy, uz}, normal{dx * inverse, dy * inverse, dz * inverse};
        const auto w = weighted(omega_a, omega_b);
        const Vec3Lanes surface = share * Vec3Lanes{w[0], w[1], w[2]};
        ContactLanes c;
        c.nx = normal.x;
        c.ny = normal.y;
        c.nz = normal.z;
        c.overlap = reach - distance;
        c.inverse_mass = inverse_mass;
        if constexpr (Law::Normal::varying || Law::has_rolling || Law::has_reach) {
            const auto pa = transpose(a), pb = transpose(b);
            c.radius = pa[3] * pb[3] / reach;
        }
        if constexpr (Law::has_dashpots) {
            const Lane to_end = lanes(0.5 * to.step.dt); // of the last step
            const auto kicks_of = [&](const auto& bodies) {
                FourLanes kicks = rows_of(movers.kick, bodies, &KickRow::ax);
                for (Lane& kick : kicks) kick = to_end * kick;
                return kicks;
            };
            const auto k = relative(kicks_of(own), kicks_of(other));
            const auto more = weighted(rows_of(movers.kick, own, &KickRow::omega_x),
                                       rows_of(movers.kick, other, &KickRow::omega_x));
            const Vec3Lanes v =
                u + Vec3Lanes{k[0], k[1], k[2]} -
                cross(surface + share * Vec3Lanes{more[0], more[1], more[2]}, normal);
            c.vx = v.x;
            c.vy = v.y;
            c.vz = v.z;
        }
        if constexpr (Law::has_rolling) {
            const auto spin = relative(omega_a, omega_b);
            c.wx = spin[0];
            c.wy = spin[1];
            c.wz = spin[2];
        }
        if constexpr (!Law::has_history) c.closing = -dot(u, normal);
        if constexpr (Law::has_history) {
            // the velocities belong to the middle of the last step, so the normal is taken there
            // too; otherwise the approach of the pair would enter its shear (Vyas et al. 2025)
            const double half_step = 0.5 * to.step.dt;
            Vec3Lanes middle{dx - half_step * ux, dy - half_step * uy, dz - half_step * uz};
            middle = inverse_root(dot(middle, middle), inverse) * middle;
            const Lane approach = dot(u, middle);
            const Vec3Lanes sliding = u - approach * middle - cross(surface, middle);
            c.closing = -approach;
            c.ux = sliding.x;
            c.uy = sliding.y;
            c.uz = sliding.z;
            c.twist = dot(surface, normal) * inverse;
        }
        return apply_law<Law, where>(to, rows, {own.data(), other.data()}, count, c,
                                     RadialArms<Law::has_rolling>{c, a, b, share},
                                     c.overlap > (0.5 * deepest) * reach);
    }
};

} // namespace bris::detail
