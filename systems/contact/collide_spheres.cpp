#include "components/kinds.hpp"
#include "components/near_spheres.hpp"
#include "components/settings.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/collide_chunk.hpp"

#include <cmath>

namespace bris {

namespace {

using detail::Movers;
using detail::TileTarget;

struct SphereGeometry {
    Movers movers;
    double deepest; // largest overlap accepted, over the mean radius

    unsigned touching(const NearEntry* near) const {
        return near_lanes(
            [&](int q) -> const SphereRow& { return movers.sphere_row[near[q].owner]; },
            [&](int q) -> const SphereRow& { return movers.sphere_row[near[q].other]; });
    }
    double gap(const NearEntry& near) const {
        const SphereRow &a = movers.sphere_row[near.owner], &b = movers.sphere_row[near.other];
        const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
        return std::sqrt(dx * dx + dy * dy + dz * dz) - (a.radius + b.radius);
    }
    double radius(const NearEntry& near) const {
        const double a = movers.sphere_row[near.owner].radius,
                     b = movers.sphere_row[near.other].radius;
        return a * b / (a + b);
    }
    void prefetch_positions(const NearEntry* near) const {
        for (std::size_t q = 0; q < 8; ++q) prefetch(&movers.sphere_row[near[q].other]);
    }
    void prefetch_rows(const TileTarget& to, const Row* rows) const {
        std::array<std::size_t, lane_count> own, other;
        for (std::size_t q = 0; q < lane_count; ++q) {
            own[q] = to.near[rows[q]].owner;
            other[q] = to.near[rows[q]].other;
        }
        movers.prefetch_rows(own);
        movers.prefetch_rows(other);
        to.prefetch_rows(rows);
    }

    template <class Law>
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
        FourLanes xa = a, xb = b; // centres of the bodies
        if (movers.centre != nullptr) {
            // converts velocities of the bodies to those of the spheres' centres
            xa = transpose(rows_of(movers.centre, own, &CentreRow::x));
            xb = transpose(rows_of(movers.centre, other, &CentreRow::x));
            const Lane ax = a[0] - xa[0], ay = a[1] - xa[1], az = a[2] - xa[2];
            const Lane bx = b[0] - xb[0], by = b[1] - xb[1], bz = b[2] - xb[2];
            u[0] += (wa[1] * az - wa[2] * ay) - (wb[1] * bz - wb[2] * by);
            u[1] += (wa[2] * ax - wa[0] * az) - (wb[2] * bx - wb[0] * bz);
            u[2] += (wa[0] * ay - wa[1] * ax) - (wb[0] * by - wb[1] * bx);
        }
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
            const auto ka = rows_of(movers.kick, own, &KickRow::vx),
                       kb = rows_of(movers.kick, other, &KickRow::vx);
            const auto k = transpose({ka[0] - kb[0], ka[1] - kb[1], ka[2] - kb[2], ka[3] - kb[3]});
            const auto ta = transpose(rows_of(movers.kick, own, &KickRow::omega_x)),
                       tb = transpose(rows_of(movers.kick, other, &KickRow::omega_x));
            const Lane ax = px - xa[0], ay = py - xa[1], az = pz - xa[2];
            const Lane bx = px - xb[0], by = py - xb[1], bz = pz - xb[2];
            const Lane wx = arm_a * wa[0] + arm_b * wb[0], wy = arm_a * wa[1] + arm_b * wb[1],
                       wz = arm_a * wa[2] + arm_b * wb[2];
            c.vx = u[0] - (wy * c.nz - wz * c.ny) + k[0] + (ta[1] * az - ta[2] * ay) -
                   (tb[1] * bz - tb[2] * by);
            c.vy = u[1] - (wz * c.nx - wx * c.nz) + k[1] + (ta[2] * ax - ta[0] * az) -
                   (tb[2] * bx - tb[0] * bz);
            c.vz = u[2] - (wx * c.ny - wy * c.nx) + k[2] + (ta[0] * ay - ta[1] * ax) -
                   (tb[0] * by - tb[1] * bx);
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
        return detail::apply_law<Law>(to, rows, own.data(), count, c,
                                      {{px, py, pz},
                                       {px - xa[0], py - xa[1], pz - xa[2]},
                                       {px - xb[0], py - xb[1], pz - xb[2]}},
                                      c.overlap > (0.5 * deepest) * reach);
    }
};

template <class Law, class Near, class Pairs, class Work>
struct Collide;
template <class Law, class... Near, class... Pairs, class... Work>
struct Collide<Law, Columns<Near...>, Columns<Pairs...>, Columns<Work...>> {
    static void
    spheres(Rows<NearSpheres, const NearPair, const PartnerSum, PairForce, Near...> near,
            detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
            Rows<SpherePairs, Pairs...> pairs, NearIndex<SpherePairs>& index,
            Rows<ForceSums, ContactSum> force_sums, const ForceGrid& grid,
            const Materials& materials, const Limits& limits, const Observation& observation,
            const Clock& clock) {
        detail::collide_all<Law>(
            detail::target_of<Law>(near, pairs, bodies,
                                   {force_sums, grid, materials, limits, observation, clock}),
            SphereGeometry{{listed, bodies, index}, limits.overlap_of_contacts()}, index);
    }
};

} // namespace

System collide_spheres(LawName law, const StepChoices& choices) {
    return system_of_law(law, choices, []<class Law, class Near, class Pairs, class Work>() {
        return system("collide_spheres", Collide<Law, Near, Pairs, Work>::spheres);
    });
}

} // namespace bris
