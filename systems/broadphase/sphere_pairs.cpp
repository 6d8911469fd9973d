#include "components/material.hpp"
#include "components/near_spheres.hpp"
#include "components/slab.hpp"
#include "systems/broadphase/carry_over.hpp"

#include <algorithm>
#include <array>

namespace bris::detail {

namespace {

/// Bodies sorted into cubic cells.
class CellGrid {
public:
    CellGrid(std::span<const Vec3> positions, std::span<const Row> rows, double side) {
        Vec3 high = Vec3::Zero();
        bool first = true;
        for (const Row r : rows) {
            // a position that is not finite goes into any cell: the guard stops the run after
            // this step
            if (!positions[r].allFinite()) continue;
            if (first) low_ = high = positions[r];
            first = false;
            low_ = low_.cwiseMin(positions[r]);
            high = high.cwiseMax(positions[r]);
        }
        side_ = side;
        // at most a few cells per body, however far away one of them is
        for (;; side_ *= 1.5) {
            double cells = 1;
            for (int a = 0; a < 3; ++a) {
                const double n = std::floor((high[a] - low_[a]) / side_) + 1;
                cells *= n;
                n_[static_cast<std::size_t>(a)] = n < 1e6 ? static_cast<int>(n) : 1000000;
            }
            if (cells <= 8.0 * static_cast<double>(rows.size()) + 1000) break;
        }
        first_.assign(static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) *
                              static_cast<std::size_t>(n_[2]) +
                          1,
                      0);
        for (const Row r : rows) ++first_[cell(at(positions[r])) + 1];
        for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        items_.resize(rows.size());
        std::vector<Row> next(first_.begin(), first_.end());
        for (const Row r : rows) items_[next[cell(at(positions[r]))]++] = r;
    }

    /// Calls body(row) for all bodies in the cells that intersect a cube of half side `reach` (m)
    /// around a point.
    template <class Body>
    void around(const Vec3& x, double reach, Body&& body) const {
        const Vec3 half = Vec3::Constant(reach);
        const auto low = at(x - half), high = at(x + half);
        for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j)
                for (Row i = first_[cell({low[0], j, k})]; i < first_[cell({high[0], j, k}) + 1];
                     ++i)
                    body(items_[i]);
    }

private:
    std::array<int, 3> at(const Vec3& x) const {
        std::array<int, 3> c;
        for (int a = 0; a < 3; ++a) {
            const auto i = static_cast<std::size_t>(a);
            c[i] = std::clamp(static_cast<int>((x[a] - low_[a]) / side_), 0, n_[i] - 1);
        }
        return c;
    }
    std::size_t cell(const std::array<int, 3>& c) const {
        const auto u = [](int i) { return static_cast<std::size_t>(i); };
        return (u(c[2]) * u(n_[1]) + u(c[1])) * u(n_[0]) + u(c[0]);
    }
    Vec3 low_ = Vec3::Zero();
    double side_ = 1;
    std::array<int, 3> n_{1, 1, 1};
    std::vector<Row> first_, items_;
};

/// Bodies in several grids by size, each with cells that suit its bodies. With one grid a large
/// body among small ones would widen all cells, and the number of pairs to test would grow as the
/// cube of the size ratio.
class SizeGrids {
public:
    /// `radii`: with skins.
    SizeGrids(std::span<const Vec3> positions, std::span<const double> radii, std::vector<Row> rows,
              double widest_ratio) {
        while (!rows.empty()) {
            double largest = 0;
            for (const Row r : rows) largest = std::max(largest, radii[r]);
            const auto smaller = std::partition(rows.begin(), rows.end(), [&](Row r) {
                return radii[r] >= largest / widest_ratio;
            });
            grids_.push_back({largest, CellGrid(positions, {rows.begin(), smaller}, 2 * largest)});
            rows.erase(rows.begin(), smaller);
        }
    }
    /// Calls body(row) for all bodies that may touch a sphere, and for some others.
    template <class Body>
    void around(const Vec3& x, double radius, Body&& body) const {
        for (const Sized& g : grids_) g.grid.around(x, radius + g.largest, body);
    }

private:
    struct Sized {
        double largest;
        CellGrid grid;
    };
    std::vector<Sized> grids_;
};

/// Data of the scene that the search reads.
struct Scene {
    std::span<const Vec3> position;
    std::span<const double> radius; ///< m, bounding radius with skin
    std::span<const EntityId> id;
    std::span<const std::uint32_t> motion, material;
    std::span<const SphereRun> run;
    std::span<const SphereRow> sphere_row;
    const Materials& materials;
    bool single; ///< every sphere is a body
};

/// Spheres of one body, with the numbers of each kind contiguous and padded to whole lanes.
struct Cluster {
    std::vector<Row> row;
    std::array<std::vector<double>, 4> numbers; ///< x, y, z and enlarged radius
    void clear(std::size_t most) {
        row.clear();
        row.reserve(most);
        for (auto& n : numbers) {
            n.clear();
            n.reserve(most + lane_count);
        }
    }
    void add(Row sphere, const SphereRow& s) {
        row.push_back(sphere);
        numbers[0].push_back(s.x);
        numbers[1].push_back(s.y);
        numbers[2].push_back(s.z);
        numbers[3].push_back(s.radius);
    }
    void pad() {
        for (auto& n : numbers) n.resize(n.size() + lane_count);
    }
    double number(std::size_t kind, std::size_t k) const { return numbers[kind][k]; }
};

// spheres of body a that reach into the bounding sphere of body b
void near_spheres(const Scene& s, Row a, Row b, Cluster& found) {
    found.clear(s.run[a].count);
    const Vec3& x = s.position[b];
    const SphereRow bounding{x.x(), x.y(), x.z(), s.radius[b]};
    const SphereRun& run = s.run[a];
    const SphereRow* sphere_row = &s.sphere_row[run.first];
    for (Row first = 0; first < run.count; first += lane_count) {
        const Row here = std::min<Row>(lane_count, run.count - first);
        const unsigned near =
            near_lanes([&](int) -> const SphereRow& { return bounding; },
                       [&](int q) -> const SphereRow& {
                           return sphere_row[first + std::min(static_cast<Row>(q), here - 1)];
                       });
        for (unsigned remaining = near & ((1u << here) - 1); remaining != 0;
             remaining &= remaining - 1) {
            const Row k = first + static_cast<Row>(__builtin_ctz(remaining));
            found.add(run.first + k, sphere_row[k]);
        }
    }
    found.pad();
}

// calls visit(k) for those spheres of a cluster that touch sphere `one` of another
template <class Visit>
void visit_touching(const Cluster& of, std::size_t one, const Cluster& cluster, Visit&& visit) {
    const Lane x = lanes(of.number(0, one)), y = lanes(of.number(1, one)),
               z = lanes(of.number(2, one)), radius = lanes(of.number(3, one));
    for (std::size_t first = 0; first < cluster.row.size(); first += lane_count) {
        const auto load = [&](std::size_t kind) {
            return load_lane(&cluster.numbers[kind][first]);
        };
        const Lane dx = load(0) - x, dy = load(1) - y, dz = load(2) - z, reach = load(3) + radius;
        const std::size_t here = std::min<std::size_t>(lane_count, cluster.row.size() - first);
        for (unsigned touching =
                 bits(dx * dx + dy * dy + dz * dz < reach * reach) & ((1u << here) - 1);
             touching != 0; touching &= touching - 1)
            visit(first + static_cast<std::size_t>(__builtin_ctz(touching)));
    }
}

struct Scratch {
    std::vector<Row> partners;
    Cluster own, other;
};

/// Rows of two bodies and of their spheres, from which their Candidate follows. There are so many
/// of them at a time that their size matters.
struct Found {
    Row own, partner, sphere, other;
};
Candidate candidate(const Scene& s, const Found& f) {
    return {
        {s.id[f.own], s.id[f.partner], f.sphere - s.run[f.own].first,
         f.other - s.run[f.partner].first},
        {f.sphere, f.other, f.partner, s.materials.pair(s.material[f.own], s.material[f.partner])}};
}

void pairs_of_bodies(const Scene& s, Row a, Row b, Scratch& scratch, std::vector<Found>& list) {
    const auto add = [&](Row i, Row j) { list.push_back({a, b, i, j}); };
    if (s.single) return add(s.run[a].first, s.run[b].first);
    const Cluster &own = scratch.own, &other = scratch.other;
    near_spheres(s, a, b, scratch.own);
    if (own.row.empty()) return;
    near_spheres(s, b, a, scratch.other);
    for (std::size_t k = 0; k < own.row.size(); ++k)
        visit_touching(own, k, other, [&](std::size_t m) { add(own.row[k], other.row[m]); });
}

} // namespace

void find_sphere_pairs(World& world) {
    Table& bodies = world.table<Bodies>();
    std::vector<double> radius(bodies.size()); // with skins
    const auto bounding = bodies.column<BoundingRadius>(), skin = bodies.column<OuterSkin>();
    for_rows(radius.size(), [&](Row b) { radius[b] = bounding[b] + skin[b]; });
    const Scene s{bodies.column<Position>(),
                  radius,
                  bodies.column<BodyId>(),
                  bodies.column<MotionOf>(),
                  bodies.column<MaterialOf>(),
                  bodies.column<SpheresOf>(),
                  world.column<Spheres, EnlargedSphere>(),
                  world.resource<Materials>(),
                  bodies.has<SphereInertia>()};
    std::vector<Row> rows;
    for (Row b = 0; b < bodies.size(); ++b)
        if (s.run[b].count > 0) rows.push_back(b);
    const SizeGrids grids(s.position, s.radius, std::move(rows),
                          world.resource<ListSettings>().widest_ratio);
    // two ghosts concern other ranks only
    const Ghosts ghosts(bodies);
    const auto free_body = [&](Row b) {
        return s.motion[b] == static_cast<std::uint32_t>(Motion::free);
    };

    ChunkLists<Found> found;
    std::vector<Row> first;
    std::vector<Scratch> scratch((bodies.size() + found.rows_per_chunk - 1) / found.rows_per_chunk);
    found.collect(bodies.size(), first, [&](std::vector<Found>& list, Row a) {
        if (s.run[a].count == 0) return;
        Scratch& mine = scratch[a / found.rows_per_chunk];
        mine.partners.clear();
        grids.around(s.position[a], s.radius[a], [&](Row b) {
            if (s.id[b] <= s.id[a] || (!free_body(a) && !free_body(b))) return;
            if (ghosts[a] && ghosts[b]) return;
            const double reach = s.radius[a] + s.radius[b];
            if ((s.position[a] - s.position[b]).squaredNorm() < reach * reach)
                mine.partners.push_back(b);
        });
        std::sort(mine.partners.begin(), mine.partners.end(),
                  [&](Row x, Row y) { return s.id[x] < s.id[y]; });
        for (const Row b : mine.partners) pairs_of_bodies(s, a, b, mine, list);
    });
    replace_pairs<SpherePairs>(world, found, first,
                               [&](const Found& f) { return candidate(s, f); });
}

} // namespace bris::detail
