#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/scalar_tile.hpp"

namespace bris {

namespace {

using detail::Movers;
using detail::TileTarget;

template <class Law>
void collide_chunk(const TileTarget& to, const Movers& movers, const PlanePlaceRow* planes,
                   NearIndex<PlanePairs>& index, double deepest, std::size_t chunk, std::size_t first, std::size_t last) {
    detail::ScalarTile<Law> tile(to, movers);
    detail::Sleepers<PlanePairs> sleepers(to, index);
    for (std::size_t group = first; group < last; group += 8) {
        if (sleepers.skips(group)) continue;
        unsigned now = 0;
        for (std::size_t row = group; row < std::min(group + 8, last); ++row) {
            const PlaceRow& p = movers.place[to.near[row].owner];
            const PlanePlaceRow& plane = planes[to.near[row].other];
            const Vec3 centre(p.x, p.y, p.z);
            const double distance = (centre - plane.point).dot(plane.normal);
            if (!(distance < p.radius)) continue;
            const unsigned bit = 1u << (row - group);
            now |= bit;
            if (sleepers.asked(group, bit) == 0) continue;
            if (p.radius - distance > deepest * p.radius) index.too_deep[chunk] = static_cast<Row>(row);
            tile.add(static_cast<Row>(row), plane.normal, distance, plane.motion.at(centre - distance * plane.normal), plane.motion.spin);
        }
        detail::book(to, index, group, sleepers.touching(group, now, index.touching[group / 8]));
    }
    tile.flush();
    sleepers.put_springs_back();
}

template <class Law>
void run(const TileTarget& to, const Movers& movers, const PlanePlaceRow* planes,
         NearIndex<PlanePairs>& index, const Limits& limits) {
    for_chunks(index.size(), near_rows_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   collide_chunk<Law>(to, movers, planes, index, limits.overlap, chunk, first, last);
               });
    index.look.clear();
}

template <class Law, class Near, class Pairs> struct Collide;
template <class Law, class... Near, class... Pairs> struct Collide<Law, Columns<Near...>, Columns<Pairs...>> {
    static void planes(Rows<NearPlanes, const NearPair, PairForce, Near...> near, detail::ListedSpheres listed,
                       detail::MovingBodies<Law> bodies, Rows<Planes, const PlanePlace> places, Rows<PlanePairs, Pairs...> pairs,
                       NearIndex<PlanePairs>& index, const Materials& materials, const Limits& limits, const Clock& clock) {
        run<Law>(detail::target_of<Law>(near, pairs, materials, clock), {listed, bodies, index}, places.column<PlanePlace>(), index,
                 limits);
    }
};

} // namespace

System collide_planes(LawName law, const StepChoices& choices) {
    return with_law(law, choices, []<class Law, class Near, class Pairs>() {
        return system("collide_planes", Collide<Law, Near, Pairs>::planes);
    });
}

} // namespace bris
