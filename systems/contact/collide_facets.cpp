#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/facet_geometry.hpp"
#include "systems/contact/facet_precision.hpp"
#include "systems/contact/scalar_tile.hpp"

#include <algorithm>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

namespace bris {

namespace {

using detail::Feature;
using detail::Nearest;
using detail::TileTarget;

// near facets of one surface and one sphere; longer runs allocate memory
constexpr std::size_t usual_run = 64;

// A surface is all facets of one body, and of bodies of the same material that move as one. Its
// facets near one sphere are a run.

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

/// Distance (m) from the sphere's centre within which facets of a run (near rows) can exert a
/// force: the radius, plus the law's reach if a facet of the run has touched the sphere.
template <class Law, class NearRows>
double reach_of(const TileTarget& to, const NearRows& rows, double radius) {
    double beyond = 0;
    if constexpr (Law::has_reach)
        for (const Row row : rows) {
            const NearEntry& near = to.near[row];
            if (Spring::keep(to.history.spring[near.pair]))
                beyond = std::max(beyond, Law::reach(to.own[near.law], radius));
        }
    return radius + beyond;
}

/// Facets within reach among the near rows of a run.
template <class Law, class NearRows>
std::span<Reached> reached_of(const Surfaces& s, const TileTarget& to, const NearRows& rows,
                              std::span<Reached> room) {
    const SphereRow& p = s.movers.sphere_row[to.near[rows[0]].owner];
    const Vec3 centre(p.x, p.y, p.z);
    const double reach = reach_of<Law>(to, rows, p.radius);
    std::size_t count = 0;
    for (const Row row : rows) {
        const Nearest n = detail::nearest_on_mesh_facet(s.facets[to.near[row].other], centre);
        if (n.distance < reach && n.distance != 0) room[count++] = {n, row, false};
    }
    return room.first(count);
}

/// Decides which facets of a run carry force.
class Choice {
public:
    Choice(const Surfaces& s, const TileTarget& to, std::span<Reached> run, double radius)
        : s_(s), to_(to), run_(run), radius_(radius) {}

    void make() const {
        for (std::size_t k = 0; k < run_.size(); ++k)
            run_[k].counts = run_[k].feature == Feature::face ? !is_seam(k) : !is_shadowed(k);
        for (Reached& r : run_)
            if (r.counts && r.feature != Feature::face && is_further_along(r)) r.counts = false;
    }

private:
    const FacetRow& facet(const Reached& r) const { return s_.facets[to_.near[r.row].other]; }

    /// The two nearest points are one. Where corners are rounded, so are the normals, and the
    /// points move by the tilt times the distance of the sphere's centre.
    bool is_same_point(const Reached& a, const Reached& b) const {
        return detail::is_together((a.point - b.point).norm(), radius_, [&] {
            return detail::rounding_of(facet(a), radius_) + detail::rounding_of(facet(b), radius_);
        });
    }

    /// The nearest point of `a` lies in the plane through a point of `b`.
    bool lies_in(const Reached& a, const Reached& b, const Vec3& point, const Vec3& normal) const {
        return detail::is_together(std::abs((a.point - point).dot(normal)), radius_, [&] {
            return detail::rounding_of(facet(a), 0) +
                   detail::rounding_of(facet(b), (a.point - b.point).norm());
        });
    }

    // an edge or vertex counts once for a surface, and not at all where a face of it carries force
    bool is_shadowed(std::size_t k) const {
        const Reached& mine = run_[k];
        for (std::size_t j = 0; j < run_.size(); ++j) {
            if (j == k) continue;
            const Reached& other = run_[j];
            if (other.feature == Feature::face) {
                const FacetRow& face = facet(other);
                if ((mine.point - other.point).norm() <= radius_ &&
                    lies_in(mine, other, face.corners[0], face.normal))
                    return true;
            } else if ((other.feature > mine.feature || (other.feature == mine.feature && j < k)) &&
                       is_same_point(mine, other)) {
                return true;
            }
        }
        return false;
    }

    // two coplanar faces share the points of their seam, where only the first one carries force
    bool is_seam(std::size_t k) const {
        for (std::size_t j = 0; j < k; ++j)
            if (run_[j].feature == Feature::face && is_same_point(run_[j], run_[k])) return true;
        return false;
    }

    // where a straight edge is divided, only the end of the farther piece is within reach, and the
    // nearer piece carries the force
    bool is_further_along(const Reached& mine) const {
        for (const Reached& other : run_)
            if (other.counts && other.distance < mine.distance &&
                (mine.point - other.point).norm() <= radius_ &&
                lies_in(mine, other, other.point, other.normal))
                return true;
        return false;
    }

    const Surfaces& s_;
    const TileTarget& to_;
    std::span<Reached> run_;
    double radius_;
};

// When a sphere slides from one facet to the next, its spring moves along: if a facet within reach
// no longer counts, its spring passes to the nearest contact of the run that has just begun. Only
// springs record past contacts, and every facet within reach is listed, so the result does not
// depend on when the lists are rebuilt.
void hand_over_springs(const TileTarget& to, std::span<const Reached> run) {
    const auto pair_of = [&](const Reached& r) { return to.near[r.row].pair; };
    for (const Reached& left : run) {
        if (left.counts || !to.history.is_kept(pair_of(left))) continue;
        const Reached* heir = nullptr;
        for (const Reached& r : run)
            if (r.counts && !to.history.is_kept(pair_of(r)) &&
                (heir == nullptr ||
                 (r.point - left.point).squaredNorm() < (heir->point - left.point).squaredNorm()))
                heir = &r;
        if (heir == nullptr) return;
        to.history.move(pair_of(left), pair_of(*heir));
    }
}

template <class Law>
class ChunkOfFacets {
public:
    ChunkOfFacets(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index,
                  std::size_t chunk)
        : s_(s), to_(to), index_(index), here_(index.chunks[chunk]),
          tile_(to, s.movers, s.deepest, index.beyond_limit[chunk]) {}

    void collide() {
        for (Row body = here_.first_body; body < here_.last_body; ++body) {
            const Row first = index_.owned_first[body], last = index_.owned_first[body + 1];
            if (first == last) continue;
            if (names(first).partner == names(last - 1).partner)
                collide_rows(std::views::iota(first, last));
            else
                collide_with_hosts(first, last);
        }
        tile_.flush();
        separated_.clear_springs(to_);
    }

private:
    const PairNames& names(Row row) const { return s_.names[to_.near[row].pair]; }
    const FacetRow& facet(Row row) const { return s_.facets[to_.near[row].other]; }

    /// Near rows of one body against one surface, sphere after sphere.
    template <class NearRows>
    void collide_rows(const NearRows& rows) {
        for (auto first = rows.begin(); first != rows.end();) {
            const auto last = std::find_if(first, rows.end(), [&](Row row) {
                return names(row).sphere != names(*first).sphere;
            });
            collide_run(std::ranges::subrange(first, last));
            first = last;
        }
    }

    /// Near rows of one body against several hosts, host after host. Those that move as one are one
    /// surface.
    void collide_with_hosts(Row first, Row last) {
        bool are_apart = true;
        hosts_.clear(); // their first rows
        for (Row row = first; row < last; ++row) {
            if (row > first && names(row).partner == names(row - 1).partner) continue;
            for (const Row host : hosts_) are_apart = are_apart && !is_one_surface(host, row);
            hosts_.push_back(row);
        }
        if (!are_apart) return collide_with_surfaces(first, last);
        hosts_.push_back(last);
        for (std::size_t k = 1; k < hosts_.size(); ++k)
            collide_rows(std::views::iota(hosts_[k - 1], hosts_[k]));
    }

    bool is_one_surface(Row a, Row b) const {
        return names(a).partner == names(b).partner ||
               (to_.near[a].law == to_.near[b].law && detail::move_as_one(facet(a), facet(b)));
    }

    void collide_with_surfaces(Row first, Row last) {
        rows_.resize(last - first);
        std::ranges::copy(std::views::iota(first, last), rows_.begin());
        for (auto begin = rows_.begin(); begin != rows_.end();) {
            const Row host = *begin; // its first row
            const auto end = std::partition(begin, rows_.end(),
                                            [&](Row row) { return is_one_surface(host, row); });
            std::sort(begin, end, [&](Row a, Row b) {
                return names(a).sphere != names(b).sphere ? names(a).sphere < names(b).sphere
                                                          : a < b;
            });
            std::sort(end, rows_.end());
            collide_rows(std::span<const Row>(begin, end));
            begin = end;
        }
    }

    template <class NearRows>
    void collide_run(const NearRows& rows) {
        std::array<Reached, usual_run> few;
        std::vector<Reached> many(rows.size() > usual_run ? rows.size() : 0);
        const std::span<Reached> run =
            reached_of<Law>(s_, to_, rows, many.empty() ? std::span<Reached>(few) : many);
        const double radius = s_.movers.sphere_row[to_.near[rows[0]].owner].radius;
        Choice(s_, to_, run, radius).make();
        if (to_.history.spring != nullptr) hand_over_springs(to_, run);
        if constexpr (Law::has_reach) { // surfaces that are apart count only while the law acts
            for (Reached& r : run)
                r.counts = r.counts && (r.distance < radius ||
                                        detail::is_held<Law>(to_, to_.near[r.row],
                                                             r.distance - radius, radius));
        }
        auto next = run.begin();
        for (const Row row : rows) {
            while (next != run.end() && (next->row < row || !next->counts)) ++next;
            const bool touches = next != run.end() && next->row == row;
            const bool touched = index_.touching[row] != 0;
            index_.touching[row] = touches ? 1 : 0;
            if (touches)
                add(row, *next);
            else if (touched)
                separate(row, radius);
        }
    }

    void add(Row row, const Nearest& at) {
        const FacetRow& here = facet(row);
        const SurfaceMotion& motion = here.motion;
        tile_.add(row, at.normal, at.distance,
                  {motion.at(at.point), motion.angular_velocity, motion.centre, here.free_host});
    }

    void separate(Row row, double radius) {
        if constexpr (Law::has_history && !Law::has_reach) {
            const Row pair = to_.near[row].pair;
            if ((Law::corrects_end || to_.work.friction != nullptr) &&
                Spring::keep(to_.history.spring[pair])) {
                const SphereRow& p = s_.movers.sphere_row[to_.near[row].owner];
                const Nearest n = detail::nearest_on_mesh_facet(facet(row), Vec3(p.x, p.y, p.z));
                if (n.distance > radius) {
                    add(row, n);
                    if (!Law::corrects_end) separated_.add(pair); // else the law clears it
                    return;
                }
            }
        }
        detail::forget(to_, row, 1);
    }

    const Surfaces& s_;
    const TileTarget& to_;
    NearIndex<FacetPairs>& index_;
    const NearChunk& here_;
    detail::ScalarTile<Law> tile_;
    detail::Separated separated_;
    std::vector<Row> hosts_, rows_; // of one body; allocated where there are several hosts
};

template <class Law>
void collide_all(const Surfaces& s, const TileTarget& to, NearIndex<FacetPairs>& index) {
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        ChunkOfFacets<Law>(s, to, index, chunk).collide();
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
