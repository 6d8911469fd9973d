#include "components/kinds.hpp"
#include "components/near_spheres.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/laws/linear.hpp"
#include "systems/contact/tile.hpp"

namespace bris {

namespace {

using detail::Movers;
using detail::TileTarget;

// bit k: near pair k of this group of lane_count touches
unsigned touching_lanes(const NearEntry* near, const PlaceRow* place) {
    return near_lanes([&](int q) -> const PlaceRow& { return place[near[q].owner]; },
                      [&](int q) -> const PlaceRow& { return place[near[q].other]; }, 0);
}

struct Tile {
    Movers movers;
    double deepest; // of the mean radius

    template <class Law>
    bool operator()(const TileTarget& to, const Row* rows, int count) const {
        alignas(64) std::array<Row, lane_count> own, other; // bodies
        for (std::size_t q = 0; q < lane_count; ++q) {
            own[q] = movers.body[to.near[rows[q]].owner];
            other[q] = movers.body[to.near[rows[q]].other];
        }
        const auto rows_of = [](const auto* table, const auto& bodies, auto member) {
            return load_rows([&](int q) { return &(table[bodies[static_cast<std::size_t>(q)]].*member); });
        };
        const auto a = transpose(load_rows([&](int q) { return &movers.place[to.near[rows[q]].owner].x; }));
        const auto b = transpose(load_rows([&](int q) { return &movers.place[to.near[rows[q]].other].x; }));
        const auto va = rows_of(movers.motion, own, &MotionRow::vx);
        const auto vb = rows_of(movers.motion, other, &MotionRow::vx);
        const Lane sign = in_each_row(Quad{-1, -1, -1, 1});
        auto u = transpose({va[0] + sign * vb[0], va[1] + sign * vb[1], va[2] + sign * vb[2],
                            va[3] + sign * vb[3]});
        const auto wa = transpose(rows_of(movers.motion, own, &MotionRow::spin_x));
        const auto wb = transpose(rows_of(movers.motion, other, &MotionRow::spin_x));
        if (movers.centre != nullptr) {
            // from velocities of the bodies to those of the spheres' centres
            const auto xa = transpose(rows_of(movers.centre, own, &CentreRow::x));
            const auto xb = transpose(rows_of(movers.centre, other, &CentreRow::x));
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
        c.overlap = max(reach - distance, lanes(0));
        c.inverse_mass = u[3];
        // the contact point lies in the middle of the overlap
        const Lane half = 0.5 * c.overlap, arm_a = a[3] - half, arm_b = b[3] - half;
        const Lane px = b[0] + c.nx * arm_b, py = b[1] + c.ny * arm_b, pz = b[2] + c.nz * arm_b;
        c.ux = u[0];
        c.uy = u[1];
        c.uz = u[2];
        c.twist = lanes(0);
        if constexpr (Law::has_history) {
            const Lane wx = arm_a * wa[0] + arm_b * wb[0], wy = arm_a * wa[1] + arm_b * wb[1],
                       wz = arm_a * wa[2] + arm_b * wb[2];
            Lane mx = c.nx, my = c.ny, mz = c.nz;
            if constexpr (!Law::damped) {
                // velocities of the last step belong to its middle, and so does this normal: or the
                // approach of the pair would leak into its shear (Vyas et al. 2025)
                const double half_step = 0.5 * to.dt;
                mx = dx - half_step * u[0];
                my = dy - half_step * u[1];
                mz = dz - half_step * u[2];
                const Lane scale = lanes(1) / max(sqrt(mx * mx + my * my + mz * mz), lanes(1e-300));
                mx *= scale;
                my *= scale;
                mz *= scale;
                const Lane approach = u[0] * mx + u[1] * my + u[2] * mz;
                c.ux -= approach * mx;
                c.uy -= approach * my;
                c.uz -= approach * mz;
            }
            c.ux -= wy * mz - wz * my;
            c.uy -= wz * mx - wx * mz;
            c.uz -= wx * my - wy * mx;
            c.twist = 0.5 * ((wa[0] + wb[0]) * c.nx + (wa[1] + wb[1]) * c.ny + (wa[2] + wb[2]) * c.nz);
        }
        detail::apply_law<Law>(to, rows, count, c, px, py, pz);
        return bits(c.overlap > (0.5 * deepest) * reach) != 0;
    }
};

template <class Law>
void collide_chunk(const TileTarget& to, const Tile& tile, NearIndex<SpherePairs>& index,
                   std::size_t chunk, std::size_t first, std::size_t last) {
    alignas(64) std::array<Row, near_rows_per_chunk + 8> touching;
    std::size_t count = 0;
    for (std::size_t group = first; group < last; group += 8) {
        unsigned now = touching_lanes(to.near + group, tile.movers.place);
        if constexpr (lane_count == 4) now |= touching_lanes(to.near + group + 4, tile.movers.place) << 4;
        if (last - group < 8) now &= (1u << (last - group)) - 1;
        std::uint8_t& flags = index.touching[group / 8];
        detail::forget(to, static_cast<Row>(group), flags & ~now);
        flags = static_cast<std::uint8_t>(now);
        for (; now != 0; now &= now - 1)
            touching[count++] = static_cast<Row>(group) + static_cast<Row>(__builtin_ctz(now));
    }
    if (count == 0) return;
    for (std::size_t k = 0; k < 8; ++k) touching[count + k] = touching[count - 1];
    for (std::size_t k = 0; k < count; k += lane_count) {
        const int here = static_cast<int>(std::min<std::size_t>(lane_count, count - k));
        if (tile.template operator()<Law>(to, &touching[k], here) && index.too_deep[chunk] == no_row)
            index.too_deep[chunk] = touching[k];
    }
}

template <class Law>
void run(const TileTarget& to, const Tile& tile, NearIndex<SpherePairs>& index, std::size_t near_rows) {
    for_chunks(near_rows, near_rows_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   collide_chunk<Law>(to, tile, index, chunk, first, last);
               });
}

template <class Law, class... Ledger>
void collide(Rows<NearSpheres, const NearPair, PairForce, Ledger...> near,
             detail::ListedSpheres listed, detail::MovingBodies bodies, Rows<SpherePairs, Spring> pairs,
             NearIndex<SpherePairs>& index, const Materials& materials, const Limits& limits, const Clock& clock) {
    const TileTarget to{near.template column<NearPair>(), pairs.column<Spring>(), near.template column<PairForce>(), detail::ledger_of(near),
                        materials.pairs.data(),  materials.pairs.size() == 1, clock.dt};
    run<Law>(to, {{listed, bodies, index}, limits.overlap}, index, index.size());
}

void collide_frictionless(Rows<NearSpheres, const NearPair, PairForce> near,
                          detail::ListedSpheres listed, detail::MovingBodies bodies, NearIndex<SpherePairs>& index,
                          const Materials& materials, const Limits& limits, const Clock& clock) {
    const TileTarget to{near.column<NearPair>(), nullptr, near.column<PairForce>(), nullptr,
                        materials.pairs.data(),  materials.pairs.size() == 1, clock.dt};
    run<LinearFrictionless>(to, {{listed, bodies, index}, limits.overlap}, index, index.size());
}

} // namespace

System collide_spheres(LawName law, bool ledger) {
    constexpr auto name = "collide_spheres";
    switch (law) {
    case LawName::linear: return ledger ? system(name, collide<Linear, SlipWork>) : system(name, collide<Linear>);
    case LawName::linear_viscous: return system(name, collide<LinearViscous>);
    case LawName::linear_frictionless: break;
    }
    return system(name, collide_frictionless);
}

} // namespace bris
