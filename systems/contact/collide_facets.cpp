#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/facet_geometry.hpp"
#include "systems/contact/scalar_tile.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace bris {

namespace {

using detail::Feature;
using detail::Nearest;
using detail::TileTarget;

// near facets of one body and one sphere; longer runs allocate memory
constexpr std::size_t usual_run = 64;

/// A facet within reach of a sphere.
struct Reached : Nearest {
    Row row;     ///< near row
    bool counts; ///< carries force; otherwise another facet of its run does so in its place
};

struct Surfaces {
    detail::Movers movers;
    const FacetRow* facets;
    const PairNames* names;
    double deepest;
};

/// Distance (m) from the sphere's centre within which facets of a run (near rows [first, last)) can
/// exert a force: the radius, plus the law's reach if a facet of the run has touched the sphere.
template <class Law>
double reach_of(const TileTarget& to, std::size_t first, std::size_t last, double radius) {
    double beyond = 0;
    if constexpr (Law::has_reach)
        for (std::size_t row = first; row < last; ++row) {
            const NearEntry& near = to.near[row];
            if (Spring::keep(to.spring[near.pair]))
                beyond = std::max(beyond, Law::reach(to.own[near.law], radius));
        }
    return radius + beyond;
}

/// Facets within reach among near rows [first, last), which are one sphere against one body.
template <class Law>
std::span<Reached> reached_of(const Surfaces& s, const TileTarget& to, std::size_t first,
                              std::size_t last, std::span<Reached> room) {
    const SphereRow& p = s.movers.sphere_row[to.near[first].owner];
    const Vec3 centre(p.x, p.y, p.z);
    const double reach = reach_of<Law>(to, first, last, p.radius);
    std::size_t count = 0;
    for (std::size_t row = first; row < last; ++row) {
        const Nearest n = detail::nearest_on_mesh_facet(s.facets[to.near[row].other], centre);
        if (n.distance < reach && n.distance != 0)
            room[count++] = {n, static_cast<Row>(row), false};
    }
    return room.first(count);
}

bool lies_in(const Vec3& point, const Vec3& of_plane, const Vec3& normal, double close) {
    return std::abs((point - of_plane).dot(normal)) <= close;
}

// an edge or vertex counts once for a body, and not at all where a face of the body carries force
bool is_shadowed(const Surfaces& s, const TileTarget& to, std::span<const Reached> run,
                 std::size_t k, double radius) {
    const Reached& mine = run[k];
    const double close = 1e-9 * radius;
    for (std::size_t j = 0; j < run.size(); ++j) {
        if (j == k) continue;
        const double apart = (mine.point - run[j].point).norm();
        if (run[j].feature == Feature::face) {
            const FacetRow& face = s.facets[to.near[run[j].row].other];
            if (apart <= radius && lies_in(mine.point, face.corners[0], face.normal, close))
                return true;
        } else if (apart <= close &&
                   (run[j].feature > mine.feature || (run[j].feature == mine.feature && j < k))) {
            return true;
        }
    }
    return false;
}

// two coplanar faces share the points of their seam, where only the first one carries force
bool is_seam(std::span<const Reached> run, std::size_t k, double radius) {
    for (std::size_t j = 0; j < k; ++j)
        if (run[j].feature == Feature::face &&
            (run[k].point - run[j].point).norm() <= 1e-9 * radius)
            return true;
    return false;
}

// where a straight edge is divided, only the end of the farther piece is within reach, and the
// nearer piece carries the force
bool is_further_along(std::span<const Reached> run, const Reached& mine, double radius) {
    for (const Reached& other : run)
        if (other.counts && other.distance < mine.distance &&
            (mine.point - other.point).norm() <= radius &&
            lies_in(mine.point, other.point, other.normal, 1e-9 * radius))
            return true;
    return false;
}

void choose(const Surfaces& s, const TileTarget& to, std::span<Reached> run, double radius) {
    for (std::size_t k = 0; k < run.size(); ++k)
        run[k].counts = run[k].feature == Feature::face ? !is_seam(run, k, radius)
                                                        : !is_shadowed(s, to, run, k, radius);
    for (Reached& r : run)
        if (r.counts && r.feature != Feature::face && is_further_along(run, r, radius))
            r.counts = false;
}

// When a sphere slides from one facet to the next, its spring moves along: if a facet within reach
// no longer counts, its spring passes to the nearest contact of the run that has just begun. Only
// springs record past contacts, and every facet within reach is listed, so the result does not
// depend on when the lists are rebuilt.
void hand_over_springs(const TileTarget& to, std::span<const Reached> run) {
    const auto pair_of = [&](const Reached& r) { return to.near[r.row].pair; };
    for (const Reached& left : run) {
        if (left.counts || !Spring::keep(to.spring[pair_of(left)])) continue;
        const Reached* heir = nullptr;
        for (const Reached& r : run)
            if (r.counts && !Spring::keep(to.spring[pair_of(r)]) &&
                (heir == nullptr ||
                 (r.point - left.point).squaredNorm() < (heir->point - left.point).squaredNorm()))
                heir = &r;
        if (heir == nullptr) return;
        to.spring[pair_of(*heir)] = std::exchange(to.spring[pair_of(left)], {});
        if (to.roll != nullptr) to.roll[pair_of(*heir)] = std::exchange(to.roll[pair_of(left)], {});
    }
}

// near rows [first, last) are one sphere against the facets of one body
template <class Law>
void collide_sphere_with_body(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index,
                              std::size_t first, std::size_t last, detail::ScalarTile<Law>& tile,
                              detail::Separated& separated) {
    std::array<Reached, usual_run> few;
    std::vector<Reached> many(last - first > usual_run ? last - first : 0);
    const std::span<Reached> run =
        reached_of<Law>(s, to, first, last, many.empty() ? std::span<Reached>(few) : many);
    const double radius = s.movers.sphere_row[to.near[first].owner].radius;
    choose(s, to, run, radius);
    if (to.spring != nullptr) hand_over_springs(to, run);
    if constexpr (Law::has_reach) { // surfaces that are apart count only while the law acts
        for (Reached& r : run)
            r.counts =
                r.counts && (r.distance < radius ||
                             detail::is_held<Law>(to, to.near[r.row], r.distance - radius, radius));
    }
    auto next = run.begin();
    for (auto row = static_cast<Row>(first); row < last; ++row) {
        while (next != run.end() && (next->row < row || !next->counts)) ++next;
        const bool touches = next != run.end() && next->row == row;
        const FacetRow& facet = s.facets[to.near[row].other];
        const SurfaceMotion& motion = facet.motion;
        const auto add = [&](const Nearest& at) {
            tile.add(
                row, at.normal, at.distance,
                {motion.at(at.point), motion.angular_velocity, motion.centre, facet.free_host});
        };
        const bool touched = index.touching[row] != 0;
        index.touching[row] = touches ? 1 : 0;
        if (touches) {
            add(*next);
        } else if (touched) {
            if constexpr (Law::has_history && !Law::has_reach) {
                const Row pair = to.near[row].pair;
                if ((Law::corrects_end || to.work.friction != nullptr) &&
                    Spring::keep(to.spring[pair])) {
                    const SphereRow& p = s.movers.sphere_row[to.near[row].owner];
                    const Nearest n = detail::nearest_on_mesh_facet(facet, Vec3(p.x, p.y, p.z));
                    if (n.distance > radius) {
                        add(n);
                        if (!Law::corrects_end) separated.add(pair); // else the law clears it
                        continue;
                    }
                }
            }
            detail::forget(to, row, 1);
        }
    }
}

template <class Law>
void collide_chunk(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index,
                   std::size_t chunk) {
    const NearChunk& here = index.chunks[chunk];
    detail::ScalarTile<Law> tile(to, s.movers, s.deepest, index.beyond_limit[chunk]);
    detail::Separated separated;
    const auto same_run = [&](std::size_t a, std::size_t b) {
        const PairNames &x = s.names[to.near[a].pair], &y = s.names[to.near[b].pair];
        return x.owner == y.owner && x.partner == y.partner && x.sphere == y.sphere;
    };
    for (std::size_t row = here.first; row < here.last;) {
        std::size_t after = row + 1;
        while (after < here.last && same_run(row, after)) ++after;
        collide_sphere_with_body<Law>(s, to, index, row, after, tile, separated);
        row = after;
    }
    tile.flush();
    separated.clear_springs(to);
}

template <class Law>
void collide_all(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index) {
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        collide_chunk<Law>(s, to, index, chunk);
    });
}

template <class Law, class Near, class Pairs, class Work>
struct Collide;
template <class Law, class... Near, class... Pairs, class... Work>
struct Collide<Law, Columns<Near...>, Columns<Pairs...>, Columns<Work...>> {
    static void facets(Rows<NearFacets, const NearPair, const PartnerSum, PairForce, Near...> near,
                       detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
                       Rows<Facets, const FacetPosition> facet_rows,
                       Rows<FacetPairs, const PairKey, Pairs...> pairs,
                       NearIndex<FacetPairs>& index, Rows<ForceSums, ContactSum> force_sums,
                       const ForceGrid& grid, const Materials& materials, const Limits& limits,
                       const Observation& observation, const Clock& clock) {
        collide_all<Law>(
            {{listed, bodies, index},
             facet_rows.template column<FacetPosition>(),
             pairs.template column<PairKey>(),
             limits.overlap_of_contacts()},
            detail::target_of<Law>(near, pairs, bodies,
                                   {force_sums, grid, materials, limits, observation, clock}),
            index);
    }
};

} // namespace

System collide_facets(LawName law, const StepChoices& choices) {
    return system_of_law(law, {.energy_budget = choices.energy_budget},
                         []<class Law, class Near, class Pairs, class Work>() {
                             return system("collide_facets",
                                           Collide<Law, Near, Pairs, Work>::facets);
                         });
}

} // namespace bris
