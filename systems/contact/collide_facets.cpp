#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/facet_geometry.hpp"
#include "systems/contact/scalar_tile.hpp"

#include <span>
#include <utility>

namespace bris {

namespace {

using detail::Feature;
using detail::Nearest;
using detail::TileTarget;

constexpr std::size_t facets_per_run = 64; // of one body near one sphere; the prune checks it

struct Surfaces {
    detail::Movers movers;
    const FacetPlaceRow* facets;
    const PairNames* names;
    double deepest;
};

Nearest nearest(const Surfaces& s, const NearEntry& near) {
    const PlaceRow& p = s.movers.place[near.owner];
    const Vec3 centre(p.x, p.y, p.z);
    const FacetPlaceRow& facet = s.facets[near.other];
    Nearest n = detail::nearest_on_mesh_facet(facet, centre);
    if (n.distance >= p.radius || n.distance == 0) n.feature = Feature::none;
    return n;
}

// an edge or vertex counts once for a body, and not at all where a face of the body already carries
bool is_shadowed(const Surfaces& s, const TileTarget& to, std::span<const Nearest> run,
                 std::size_t first, std::size_t k) {
    const Nearest& mine = run[k];
    const double radius = s.movers.place[to.near[first + k].owner].radius, close = 1e-9 * radius;
    for (std::size_t j = 0; j < run.size(); ++j) {
        if (j == k || run[j].feature == Feature::none) continue;
        if (run[j].feature == Feature::face) {
            const FacetPlaceRow& face = s.facets[to.near[first + j].other];
            if (std::abs((mine.point - face.corners[0]).dot(face.normal)) <= close &&
                (mine.point - run[j].point).norm() <= radius)
                return true;
        } else if ((j < k || run[j].feature > mine.feature) && (mine.point - run[j].point).norm() <= close) {
            return true;
        }
    }
    return false;
}

// two faces on one plane share the points of their seam: the first carries
bool is_counted(std::span<const Nearest> run, std::size_t k, double radius) {
    for (std::size_t j = 0; j < k; ++j)
        if (run[j].feature == Feature::face && (run[k].point - run[j].point).norm() <= 1e-9 * radius) return true;
    return false;
}

// A sphere that slides from one facet to the next takes its spring along: where a contact has begun
// and another of the run counts no more, though still in reach, the spring goes over, to the nearest.
// Only springs tell which contacts there were, and what is in reach is listed, so lists leave no trace.
void hand_over_springs(const TileTarget& to, std::span<const Nearest> run, std::size_t first, std::uint64_t touching) {
    const auto spring_of = [&](std::size_t k) -> SpringRow& { return to.spring[to.near[first + k].pair]; };
    for (std::size_t d = 0; d < run.size(); ++d) {
        if (((touching >> d) & 1) != 0 || run[d].feature == Feature::none || !Spring::keep(spring_of(d))) continue;
        std::size_t heir = run.size();
        for (std::size_t k = 0; k < run.size(); ++k)
            if (((touching >> k) & 1) != 0 && !Spring::keep(spring_of(k)) &&
                (heir == run.size() || (run[k].point - run[d].point).squaredNorm() < (run[heir].point - run[d].point).squaredNorm()))
                heir = k;
        if (heir == run.size()) return;
        spring_of(heir) = spring_of(d);
        spring_of(d) = {};
        if (to.roll != nullptr) to.roll[to.near[first + heir].pair] = std::exchange(to.roll[to.near[first + d].pair], {});
    }
}

// near rows [first, last) are one sphere against the facets of one body
template <class Law>
std::uint64_t collide_sphere_with_body(const Surfaces& s, const TileTarget& to, std::size_t first,
                                       std::size_t last, detail::ScalarTile<Law>& tile, Row& too_deep) {
    std::array<Nearest, facets_per_run> found;
    for (std::size_t row = first; row < last; ++row) found[row - first] = nearest(s, to.near[row]);
    const std::span<const Nearest> run(found.data(), last - first);
    const double radius = s.movers.place[to.near[first].owner].radius;
    std::uint64_t touching = 0;
    for (std::size_t k = 0; k < run.size(); ++k) {
        if (run[k].feature == Feature::none) continue;
        const bool again = run[k].feature == Feature::face ? is_counted(run, k, radius) : is_shadowed(s, to, run, first, k);
        if (!again) touching |= std::uint64_t{1} << k;
    }
    if (touching != 0 && to.spring != nullptr) hand_over_springs(to, run, first, touching);
    for (std::uint64_t rest = touching; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(__builtin_ctzll(rest));
        const auto row = static_cast<Row>(first + k);
        if (radius - run[k].distance > s.deepest * radius) too_deep = row;
        const SurfaceMotion& motion = s.facets[to.near[row].other].motion;
        tile.add(row, run[k].normal, run[k].distance, motion.at(run[k].point), motion.spin);
    }
    return touching;
}

template <class Law>
void collide_chunk(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index,
                   std::size_t chunk, std::size_t first, std::size_t last) {
    detail::ScalarTile<Law> tile(to, s.movers);
    const std::size_t end = index.size();
    const auto same_run = [&](std::size_t a, std::size_t b) {
        const PairNames &x = s.names[to.near[a].pair], &y = s.names[to.near[b].pair];
        return x.owner == y.owner && x.partner == y.partner && x.sphere == y.sphere;
    };
    // runs belong to the chunk in which they begin
    std::size_t row = first;
    while (row < last && row > 0 && same_run(row - 1, row)) ++row;
    while (row < last) {
        std::size_t after = row + 1;
        while (after < end && after - row < facets_per_run && same_run(row, after)) ++after;
        const std::uint64_t now =
            collide_sphere_with_body<Law>(s, to, row, after, tile, index.too_deep[chunk]);
        for (std::size_t k = row; k < after; ++k) {
            const bool touches = ((now >> (k - row)) & 1) != 0;
            if (index.touching[k] != 0 && !touches) detail::forget(to, static_cast<Row>(k), 1);
            index.touching[k] = touches ? 1 : 0;
        }
        row = after;
    }
    tile.flush();
}

template <class Law> void run_chunks(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index) {
    for_chunks(index.size(), near_rows_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   collide_chunk<Law>(s, to, index, chunk, first, last);
               });
}

template <class Law, class Near, class Pairs> struct Collide;
template <class Law, class... Near, class... Pairs> struct Collide<Law, Columns<Near...>, Columns<Pairs...>> {
    static void facets(Rows<NearFacets, const NearPair, PairForce, Near...> near, detail::ListedSpheres listed,
                       detail::MovingBodies<Law> bodies, Rows<Facets, const FacetPlace> places,
                       Rows<FacetPairs, const PairKey, Pairs...> pairs, NearIndex<FacetPairs>& index, const Materials& materials,
                       const Limits& limits, const Clock& clock) {
        run_chunks<Law>({{listed, bodies, index}, places.template column<FacetPlace>(), pairs.template column<PairKey>(), limits.overlap},
                        detail::target_of<Law>(near, pairs, materials, clock), index);
    }
};

} // namespace

System collide_facets(LawName law, const StepChoices& choices) {
    return with_law(law, {.ledger = choices.ledger}, []<class Law, class Near, class Pairs>() {
        return system("collide_facets", Collide<Law, Near, Pairs>::facets);
    });
}

} // namespace bris
