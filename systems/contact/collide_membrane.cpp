#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/laws/linear.hpp"
#include "components/membrane_surface.hpp"
#include "systems/contact/scalar_tile.hpp"

namespace bris {

namespace {

using detail::TileTarget;

struct Band {
    MembraneSurface surface;
    const PlaceRow* place;
    const double* speed; // by element
    Foot* foot;          // by near row
    double deepest;
};

template <class Law>
void collide_chunk(const TileTarget& to, const Band& band, NearIndex<MembranePairs>& index, std::size_t chunk,
                   std::size_t first, std::size_t last) {
    detail::ScalarTile<Law> tile(to, band.place, nullptr);
    for (std::size_t group = first; group < last; group += 8) {
        unsigned now = 0;
        for (std::size_t k = group; k < std::min(group + 8, last); ++k) {
            const auto row = static_cast<Row>(k);
            const PlaceRow& p = band.place[to.near[row].owner];
            const auto sector = static_cast<int>(to.near[row].other);
            const Vec3& outward = band.surface.outward[sector];
            const double out = p.x * outward.x() + p.y * outward.y();
            if (out + p.radius < band.surface.least_radius(sector, p.z)) continue;
            const auto n = band.surface.nearest(sector, out, p.z);
            if (!(n.distance < p.radius)) continue;
            now |= 1u << (k - group);
            if (p.radius - n.distance > band.deepest * p.radius) index.too_deep[chunk] = row;
            band.foot[row] = n.foot;
            const double speed = (1 - n.foot.share) * band.speed[n.foot.lower] + n.foot.share * band.speed[n.foot.upper];
            tile.add(row, Vec3(n.radial * outward.x(), n.radial * outward.y(), n.axial), n.distance, speed * outward);
        }
        detail::book(to, index, group, now);
    }
    tile.flush();
}

// a membrane has no friction, whatever the law between grains
template <class Law>
void collide(Rows<NearMembrane, const NearPair, PairForce, FootOf> near, Rows<Listed, const Place> listed,
             Rows<Elements, const ElementRadius, const ElementSpeed> elements, NearIndex<MembranePairs>& index,
             const Membrane& membrane, const Materials& materials, const Limits& limits, const Clock& clock) {
    const TileTarget to{near.column<NearPair>(), nullptr, near.column<PairForce>(), nullptr,
                        materials.pairs.data(), materials.pairs.size() == 1, clock.dt};
    const Band band{{membrane, elements.column<ElementRadius>()}, listed.column<Place>(), elements.column<ElementSpeed>(),
                    near.column<FootOf>(), limits.overlap};
    for_chunks(index.size(), detail::near_rows_per_chunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        collide_chunk<Law>(to, band, index, chunk, first, last);
    });
}

} // namespace

System collide_membrane(LawName law) {
    constexpr auto name = "collide_membrane";
    if (law == LawName::linear_viscous) return system(name, collide<LinearViscousFrictionless>);
    return system(name, collide<LinearFrictionless>);
}

} // namespace bris
