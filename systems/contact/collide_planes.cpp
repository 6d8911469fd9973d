#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/laws/linear.hpp"
#include "systems/contact/scalar_tile.hpp"

namespace bris {

namespace {

using detail::Movers;
using detail::TileTarget;

template <class Law>
void collide_chunk(const TileTarget& to, const Movers& movers, const PlanePlaceRow* planes,
                   NearIndex<PlanePairs>& index, double deepest, std::size_t chunk, std::size_t first, std::size_t last) {
    detail::ScalarTile<Law> tile(to, movers);
    for (std::size_t group = first; group < last; group += 8) {
        unsigned now = 0;
        for (std::size_t row = group; row < std::min(group + 8, last); ++row) {
            const PlaceRow& p = movers.place[to.near[row].owner];
            const PlanePlaceRow& plane = planes[to.near[row].other];
            const double distance = (Vec3(p.x, p.y, p.z) - plane.point).dot(plane.normal);
            if (!(distance < p.radius)) continue;
            now |= 1u << (row - group);
            if (p.radius - distance > deepest * p.radius) index.too_deep[chunk] = static_cast<Row>(row);
            tile.add(static_cast<Row>(row), plane.normal, distance, plane.velocity);
        }
        detail::book(to, index, group, now);
    }
    tile.flush();
}

template <class Law>
void run(const TileTarget& to, const Movers& movers, const PlanePlaceRow* planes,
         NearIndex<PlanePairs>& index, const Limits& limits) {
    for_chunks(index.size(), near_rows_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   collide_chunk<Law>(to, movers, planes, index, limits.overlap, chunk, first, last);
               });
}

template <class Law, class... Ledger>
void collide(Rows<NearPlanes, const NearPair, PairForce, Ledger...> near,
             detail::ListedSpheres listed, detail::MovingBodies bodies, Rows<Planes, const PlanePlace> planes,
             Rows<PlanePairs, Spring> pairs, NearIndex<PlanePairs>& index, const Materials& materials,
             const Limits& limits, const Clock& clock) {
    run<Law>({near.template column<NearPair>(), pairs.column<Spring>(), near.template column<PairForce>(), detail::ledger_of(near),
              materials.pairs.data(), materials.pairs.size() == 1, clock.dt},
             {listed, bodies, index}, planes.column<PlanePlace>(), index, limits);
}

void collide_frictionless(Rows<NearPlanes, const NearPair, PairForce> near,
                          detail::ListedSpheres listed, detail::MovingBodies bodies, Rows<Planes, const PlanePlace> planes,
                          NearIndex<PlanePairs>& index, const Materials& materials,
                          const Limits& limits, const Clock& clock) {
    run<LinearFrictionless>({near.column<NearPair>(), nullptr, near.column<PairForce>(), nullptr,
                             materials.pairs.data(), materials.pairs.size() == 1, clock.dt},
                            {listed, bodies, index}, planes.column<PlanePlace>(), index, limits);
}

} // namespace

System collide_planes(LawName law, bool ledger) {
    constexpr auto name = "collide_planes";
    switch (law) {
    case LawName::linear: return ledger ? system(name, collide<Linear, SlipWork>) : system(name, collide<Linear>);
    case LawName::linear_viscous: return system(name, collide<LinearViscous>);
    case LawName::linear_frictionless: break;
    }
    return system(name, collide_frictionless);
}

} // namespace bris
