#pragma once

#include "systems/contact/sphere_surfaces.hpp"

namespace bris::detail {

/// Contacts of spheres that belong to clumps, in the middle of the overlap.
struct ClumpSpheres : SphereSurfaces {
    template <class Law, SumsAt where>
    unsigned collide(const TileTarget& to, const Row* rows, int count) const {
        // own, other: rows of bodies
        std::array<std::size_t, lane_count> own_sphere, other_sphere, own, other;
        for (std::size_t q = 0; q < lane_count; ++q) {
            const NearEntry& e = to.near[rows[q]];
            own[q] = movers.body_of(own_sphere[q] = e.owner);
            other[q] = movers.body_of(other_sphere[q] = e.other);
        }
        const auto rows_of = [](const auto* table, const auto& bodies, auto member) {
            return load_rows(
                [&](int q) { return &(table[bodies[static_cast<std::size_t>(q)]].*member); });
        };
        const auto a = transpose(rows_of(movers.sphere_row, own_sphere, &SphereRow::x));
        const auto b = transpose(rows_of(movers.sphere_row, other_sphere, &SphereRow::x));
        const auto va = rows_of(movers.motion, own, &MotionRow::vx);
        const auto vb = rows_of(movers.motion, other, &MotionRow::vx);
        const Lane sign = in_each_row(Quad{-1, -1, -1, 1});
        auto u = transpose({va[0] + sign * vb[0], va[1] + sign * vb[1], va[2] + sign * vb[2],
                            va[3] + sign * vb[3]});
        const auto wa = transpose(rows_of(movers.motion, own, &MotionRow::omega_x));
        const auto wb = transpose(rows_of(movers.motion, other, &MotionRow::omega_x));
        // converts velocities of the bodies to those of the spheres' centres
        const auto xa = transpose(rows_of(movers.centre, own, &CentreRow::x)),
                   xb = transpose(rows_of(movers.centre, other, &CentreRow::x));
        const Lane ax = a[0] - xa[0], ay = a[1] - xa[1], az = a[2] - xa[2];
        const Lane bx = b[0] - xb[0], by = b[1] - xb[1], bz = b[2] - xb[2];
        u[0] += (wa[1] * az - wa[2] * ay) - (wb[1] * bz - wb[2] * by);
        u[1] += (wa[2] * ax - wa[0] * az) - (wb[2] * bx - wb[0] * bz);
        u[2] += (wa[0] * ay - wa[1] * ax) - (wb[0] * by - wb[1] * bx);
        const Lane dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2], reach = a[3] + b[3];
        const Lane distance = max(sqrt(dx * dx + dy * dy + dz * dz), lanes(1e-300));
        const Lane inverse = lanes(1) / distance;
        ContactLanes c;
        c.nx = dx * inverse;
        c.ny = dy * inverse;
        c.nz = dz * inverse;
        c.overlap = reach - distance;
        c.inverse_mass = u[3];
        if constexpr (Law::Normal::varying || Law::has_rolling || Law::has_reach)
            c.radius = a[3] * b[3] / reach;
        // the contact point lies in the middle of the overlap
        const Lane half = 0.5 * c.overlap, arm_a = a[3] - half, arm_b = b[3] - half;
        const Lane px = b[0] + c.nx * arm_b, py = b[1] + c.ny * arm_b, pz = b[2] + c.nz * arm_b;
        if constexpr (Law::has_dashpots) {
            const auto ka = rows_of(movers.kick, own, &KickRow::ax),
                       kb = rows_of(movers.kick, other, &KickRow::ax);
            const Lane to_end = lanes(0.5 * to.step.dt); // of the last step
            const auto k =
                transpose({to_end * ka[0] - to_end * kb[0], to_end * ka[1] - to_end * kb[1],
                           to_end * ka[2] - to_end * kb[2], to_end * ka[3] - to_end * kb[3]});
            const auto ta = transpose(rows_of(movers.kick, own, &KickRow::omega_x)),
                       tb = transpose(rows_of(movers.kick, other, &KickRow::omega_x));
            const Lane cx = px - xa[0], cy = py - xa[1], cz = pz - xa[2];
            const Lane ex = px - xb[0], ey = py - xb[1], ez = pz - xb[2];
            const Lane wx = arm_a * wa[0] + arm_b * wb[0], wy = arm_a * wa[1] + arm_b * wb[1],
                       wz = arm_a * wa[2] + arm_b * wb[2];
            c.vx = u[0] - (wy * c.nz - wz * c.ny) + k[0] + (ta[1] * cz - ta[2] * cy) -
                   (tb[1] * ez - tb[2] * ey);
            c.vy = u[1] - (wz * c.nx - wx * c.nz) + k[1] + (ta[2] * cx - ta[0] * cz) -
                   (tb[2] * ex - tb[0] * ez);
            c.vz = u[2] - (wx * c.ny - wy * c.nx) + k[2] + (ta[0] * cy - ta[1] * cx) -
                   (tb[0] * ey - tb[1] * ex);
        }
        if constexpr (Law::has_rolling) {
            c.wx = wa[0] - wb[0];
            c.wy = wa[1] - wb[1];
            c.wz = wa[2] - wb[2];
        }
        if constexpr (!Law::has_history) c.closing = -(u[0] * c.nx + u[1] * c.ny + u[2] * c.nz);
        if constexpr (Law::has_history) {
            const Lane wx = arm_a * wa[0] + arm_b * wb[0], wy = arm_a * wa[1] + arm_b * wb[1],
                       wz = arm_a * wa[2] + arm_b * wb[2];
            // the velocities belong to the middle of the last step, so the normal is taken there
            // too; otherwise the approach of the pair would enter its shear (Vyas et al. 2025)
            const double half_step = 0.5 * to.step.dt;
            Lane mx = dx - half_step * u[0], my = dy - half_step * u[1], mz = dz - half_step * u[2];
            const Lane scale = inverse_root(mx * mx + my * my + mz * mz, inverse);
            mx *= scale;
            my *= scale;
            mz *= scale;
            const Lane approach = u[0] * mx + u[1] * my + u[2] * mz;
            c.closing = -approach;
            c.ux = u[0] - approach * mx - (wy * mz - wz * my);
            c.uy = u[1] - approach * my - (wz * mx - wx * mz);
            c.uz = u[2] - approach * mz - (wx * my - wy * mx);
            c.twist =
                0.5 * ((wa[0] + wb[0]) * c.nx + (wa[1] + wb[1]) * c.ny + (wa[2] + wb[2]) * c.nz);
        }
        return apply_law<Law, where>(to, rows, {own.data(), other.data()}, count, c,
                                     Levers{{px, py, pz},
                                            {px - xa[0], py - xa[1], pz - xa[2]},
                                            {px - xb[0], py - xb[1], pz - xb[2]}},
                                     c.overlap > (0.5 * deepest) * reach);
    }
};

} // namespace bris::detail
