#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/lane_math.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/collide_chunk.hpp"

namespace bris {

namespace {

using detail::Movers;
using detail::TileTarget;

Vec3Lanes vector(const FourLanes& a) { return {a[0], a[1], a[2]}; }

/// Four consecutive numbers of the rows of planes, starting at `from`; one plane per lane.
template <class PlaneOf>
FourLanes four_of(PlaneOf&& plane, std::ptrdiff_t from) {
    static_assert(sizeof(PlaneRow) == 15 * sizeof(double));
    return transpose(load_rows([&](int q) { return plane(q).point.data() + from; }));
}

struct PlaneGeometry {
    Movers movers;
    const PlaneRow* planes;
    double deepest; // largest overlap accepted, over the radius

    unsigned touching(const NearEntry* near) const {
        const auto a =
            transpose(load_rows([&](int q) { return &movers.sphere_row[near[q].owner].x; }));
        const auto plane = [&](int q) -> const PlaneRow& { return planes[near[q].other]; };
        const auto p = four_of(plane, 0), n = four_of(plane, 2); // n[0]: z of the point
        return bits(dot({a[0] - p[0], a[1] - p[1], a[2] - p[2]}, {n[1], n[2], n[3]}) < a[3]);
    }
    double gap(const NearEntry& near) const {
        const SphereRow& a = movers.sphere_row[near.owner];
        const PlaneRow& p = planes[near.other];
        return (Vec3(a.x, a.y, a.z) - p.point).dot(p.normal) - a.radius;
    }
    double radius(const NearEntry& near) const { return movers.sphere_row[near.owner].radius; }
    // of the planes, which are few, nothing is prefetched
    void prefetch_positions(const NearEntry* near) const {
        for (std::size_t q = 0; q < 8; ++q) prefetch(&movers.sphere_row[near[q].owner]);
    }
    template <detail::SumsAt where>
    void prefetch_rows(const TileTarget& to, const Row* rows) const {
        const auto own = movers.bodies_of([&](std::size_t q) { return to.near[rows[q]].owner; });
        movers.prefetch_rows(own);
        to.prefetch_rows<where>(rows, {own.data(), own.data()});
    }
    template <class Law, detail::SumsAt where>
    unsigned collide(const TileTarget& to, const Row* rows, int count) const {
        std::array<std::size_t, lane_count> slot, own; // own: rows of bodies
        for (std::size_t q = 0; q < lane_count; ++q)
            own[q] = movers.body_of(slot[q] = to.near[rows[q]].owner);
        const auto rows_of = [](const auto* table, const auto& bodies, auto member) {
            return transpose(load_rows(
                [&](int q) { return &(table[bodies[static_cast<std::size_t>(q)]].*member); }));
        };
        const auto plane = [&](int q) -> const PlaneRow& { return planes[to.near[rows[q]].other]; };
        const auto a = rows_of(movers.sphere_row, slot, &SphereRow::x);
        const auto p0 = four_of(plane, 0), p4 = four_of(plane, 4), p8 = four_of(plane, 8),
                   p11 = four_of(plane, 11);
        const Vec3Lanes foot{p0[0], p0[1], p0[2]}, normal{p0[3], p4[0], p4[1]},
            drift{p4[2], p4[3], p8[0]}, turning{p8[1], p8[2], p8[3]}, pivot{p11[1], p11[2], p11[3]};
        const Vec3Lanes centre = vector(a);
        const Lane distance = dot(centre - foot, normal), overlap = a[3] - distance,
                   arm = a[3] - 0.5 * overlap;
        const Vec3Lanes point = centre - arm * normal; // in the middle of the overlap
        const auto v = rows_of(movers.motion, own, &MotionRow::vx);
        const Vec3Lanes omega = vector(rows_of(movers.motion, own, &MotionRow::omega_x));
        Vec3Lanes u = vector(v) - (drift + cross(turning, centre - distance * normal - pivot)),
                  middle = centre; // of the body
        if (movers.centre != nullptr) {
            middle = vector(rows_of(movers.centre, own, &CentreRow::x));
            u = u + cross(omega, centre - middle);
        }
        ContactLanes c{normal.x, normal.y, normal.z, overlap, v[3], a[3]};
        c.closing = -dot(u, normal);
        if constexpr (Law::has_history) {
            u = u - arm * cross(omega, normal);
            c.twist = 0.5 * dot(omega + turning, normal);
            c.ux = u.x, c.uy = u.y, c.uz = u.z;
        }
        if constexpr (Law::has_dashpots) {
            const Vec3Lanes kick =
                                0.5 * to.step.dt * vector(rows_of(movers.kick, own, &KickRow::ax)),
                            more = vector(rows_of(movers.kick, own, &KickRow::omega_x));
            const Vec3Lanes now = u + kick + cross(more, point - middle);
            c.vx = now.x, c.vy = now.y, c.vz = now.z;
        }
        if constexpr (Law::has_rolling) {
            const Vec3Lanes w = omega - turning;
            c.wx = w.x, c.wy = w.y, c.wz = w.z;
        }
        return detail::apply_law<Law, where>(to, rows, {own.data(), own.data()}, count, c,
                                             detail::Levers{point, point - middle, point - pivot},
                                             overlap > deepest * a[3]);
    }
};

template <class Law, class Near, class Pairs, class Work>
struct Collide;
template <class Law, class... Near, class... Pairs, class... Work>
struct Collide<Law, Columns<Near...>, Columns<Pairs...>, Columns<Work...>> {
    static void planes(Rows<NearPlanes, const NearPair, const PartnerSum, PairForce, Near...> near,
                       detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
                       Rows<Planes, const PlanePosition> plane_rows,
                       Rows<PlanePairs, Pairs...> pairs, NearIndex<PlanePairs>& index,
                       Rows<ForceSums, ContactSum> force_sums, const ForceGrid& grid,
                       const Materials& materials, const Limits& limits,
                       const Observation& observation, const Clock& clock) {
        detail::collide_all<Law>(
            detail::target_of<Law>(near, pairs, bodies,
                                   {force_sums, grid, materials, limits, observation, clock}),
            PlaneGeometry{{listed, bodies, index},
                          plane_rows.column<PlanePosition>(),
                          limits.overlap_of_contacts()},
            index);
    }
};

} // namespace

System collide_planes(LawName law, const StepChoices& choices) {
    return system_of_law(law, choices, []<class Law, class Near, class Pairs, class Work>() {
        return system("collide_planes", Collide<Law, Near, Pairs, Work>::planes);
    });
}

} // namespace bris
