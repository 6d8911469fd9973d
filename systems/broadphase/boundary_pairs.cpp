#include "components/boundary.hpp"
#include "components/material.hpp"
#include "components/membrane_surface.hpp"
#include "components/slab.hpp"
#include "engine/ordering.hpp"
#include "systems/broadphase/carry_over.hpp"
#include "systems/broadphase/flat_parts.hpp"
#include "systems/broadphase/skins.hpp"
#include "systems/broadphase/sphere_rows.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace bris::detail {

namespace {

// Makes the candidates of every free body with the boundary parts (planes, facets or sectors of a
// membrane) that `parts_around` returns for it and that `near_body` and `near_sphere` accept,
// ordered by (host id, sphere, part id). `near_sphere` is given the enlarged radius.
template <class Pairs, class PartsAround, class NearBody, class NearSphere>
void find_pairs(World& world, std::span<const EntityId> part, std::span<const Row> host,
                PartsAround&& parts_around, NearBody&& near_body, NearSphere&& near_sphere) {
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto run = bodies.column<SpheresOf>();
    const auto id = bodies.column<BodyId>();
    // the forces of ghosts on boundaries are found by the ranks that own them
    const Ghosts ghosts(bodies);
    const auto material = bodies.column<MaterialOf>();
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto& materials = world.resource<Materials>();
    ChunkLists<Candidate> found;
    std::vector<Row> first;
    found.collect(bodies.size(), first, [&](std::vector<Candidate>& list, Row b) {
        if (run[b].count == 0 || motion[b] != static_cast<std::uint32_t>(Motion::free)) return;
        if (ghosts[b]) return;
        const std::size_t begin = list.size();
        for (const Row e : parts_around(b)) {
            if (!near_body(b, e)) continue;
            const std::uint32_t law = materials.pair(material[b], material[host[e]]);
            for (Row k = run[b].first; k < run[b].first + run[b].count; ++k)
                if (near_sphere(centre_of(sphere_row[k]), sphere_row[k].radius, e))
                    list.push_back(
                        {{id[b], id[host[e]], k - run[b].first, part[e]}, {k, e, host[e], law}});
        }
        std::sort(list.begin() + static_cast<std::ptrdiff_t>(begin), list.end(),
                  [](const Candidate& x, const Candidate& y) { return x.names < y.names; });
    });
    replace_pairs<Pairs>(world, found, first);
}

/// Boxes sorted into cells, to find those that may contain a point.
class BoxGrid {
public:
    explicit BoxGrid(const std::vector<Eigen::AlignedBox3d>& boxes) {
        for (const auto& box : boxes) all_.extend(box);
        if (boxes.empty()) return;
        side_ = std::max(all_.sizes().maxCoeff() / cells_along, std::numeric_limits<double>::min());
        n_ = cell(all_.max()) + Eigen::Array3i::Ones();
        first_.assign(static_cast<std::size_t>(n_.prod()) + 1, 0);
        for_cells(boxes, [&](std::size_t c, Row) { ++first_[c + 1]; });
        for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        items_.resize(first_.back());
        std::vector<Row> next(first_.begin(), first_.end());
        for_cells(boxes, [&](std::size_t c, Row e) { items_[next[c]++] = e; });
    }

    /// Rows that include every box that contains x; none if x is outside all boxes or not a number.
    std::span<const Row> around(const Vec3& x) const {
        if (first_.empty() || !all_.contains(Eigen::Vector3d(x))) return {};
        const std::size_t c = number(cell(Eigen::Vector3d(x)));
        return {items_.data() + first_[c], items_.data() + first_[c + 1]};
    }

private:
    // along the longest side: a few thousand cells around a vessel
    static constexpr int cells_along = 32;

    Eigen::Array3i cell(const Eigen::Vector3d& x) const {
        return ((x - all_.min()) / side_).array().cast<int>();
    }
    std::size_t number(const Eigen::Array3i& c) const {
        return static_cast<std::size_t>((c[2] * n_[1] + c[1]) * n_[0] + c[0]);
    }
    template <class Visit>
    void for_cells(const std::vector<Eigen::AlignedBox3d>& boxes, Visit&& visit) const {
        for (Row e = 0; e < boxes.size(); ++e) {
            const Eigen::Array3i low = cell(boxes[e].min()), high = cell(boxes[e].max());
            for (int k = low[2]; k <= high[2]; ++k)
                for (int j = low[1]; j <= high[1]; ++j)
                    for (int i = low[0]; i <= high[0]; ++i) visit(number({i, j, k}), e);
        }
    }
    Eigen::AlignedBox3d all_;
    double side_ = 1;
    Eigen::Array3i n_ = Eigen::Array3i::Zero();
    std::vector<Row> first_, items_;
};

// largest radius of a free body, with its skin
double largest_enlarged_radius(const Table& bodies) {
    const auto radius = bodies.column<BoundingRadius>(), skin = bodies.column<OuterSkin>();
    const auto run = bodies.column<SpheresOf>();
    const auto motion = bodies.column<MotionOf>();
    double largest = 0;
    for (Row b = 0; b < bodies.size(); ++b)
        if (run[b].count > 0 && motion[b] == static_cast<std::uint32_t>(Motion::free))
            largest = std::max(largest, radius[b] + skin[b]);
    return largest;
}

} // namespace

void find_plane_pairs(World& world) {
    Table &planes = world.table<Planes>(), &bodies = world.table<Bodies>();
    const auto host = planes.column<HostRow>();
    const auto shape = planes.column<LocalPlane>();
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>(), skin = bodies.column<OuterSkin>();
    const auto height = [&](const Vec3& x, Row e) {
        return (x - position[host[e]] - shape[e].point).dot(shape[e].normal);
    };
    const auto all = all_rows(planes.size());
    find_pairs<PlanePairs>(
        world, planes.column<PlaneId>(), host, [&](Row) -> const std::vector<Row>& { return all; },
        [&](Row b, Row e) { return height(position[b], e) < radius[b] + skin[b] + skin[host[e]]; },
        [&](const Vec3& x, double r, Row e) { return height(x, e) < r + skin[host[e]]; });
}

namespace {

/// Candidates of flat parts with these ids and rows of their hosts.
template <class Pairs>
void find_flat_pairs(World& world, std::span<const EntityId> id, std::span<const Row> host,
                     const std::vector<FlatPart>& parts) {
    Table& bodies = world.table<Bodies>();
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>(), skin = bodies.column<OuterSkin>();
    const double beyond = reach_beyond_skin(world);
    // a sphere out of reach of a part's box or of its plane is out of reach of the part
    const auto reaches = [&](const Vec3& x, double r, Row e) {
        const double reach = r + skin[host[e]] + beyond;
        return parts[e].from_plane(x) < reach && parts[e].from_box(x) < reach;
    };
    std::vector<Eigen::AlignedBox3d> within_reach;
    const double largest = largest_enlarged_radius(bodies) + beyond;
    // with few boxes a grid costs more than it saves if fast bodies need new lists in every step
    const auto all = all_rows(parts.size());
    const bool few = all.size() <= 16;
    for (std::size_t e = 0; e < parts.size() && !few; ++e) {
        const Eigen::Vector3d margin = Eigen::Vector3d::Constant(largest + skin[host[e]]);
        within_reach.emplace_back(parts[e].box.min() - margin, parts[e].box.max() + margin);
    }
    const BoxGrid grid(within_reach);
    find_pairs<Pairs>(
        world, id, host,
        [&](Row b) { return few ? std::span<const Row>(all) : grid.around(position[b]); },
        [&](Row b, Row e) { return reaches(position[b], radius[b] + skin[b], e); }, reaches);
}

} // namespace

void find_facet_pairs(World& world) {
    Table& facets = world.table<Facets>();
    const auto host = facets.column<HostRow>();
    const auto shape = facets.column<LocalFacet>();
    const Poses<> poses(world);
    std::vector<FlatPart> parts;
    for (std::size_t e = 0; e < shape.size(); ++e) {
        const Pose pose = poses[host[e]];
        parts.push_back(FlatPart(placed(shape[e], pose.position, pose.orientation).corners));
    }
    find_flat_pairs<FacetPairs>(world, facets.column<FacetId>(), host, parts);
}

void find_triangle_pairs(World& world) {
    const std::vector<FlatPart> parts = flat_parts_of_sleeve(world);
    const std::vector<Row> host(parts.size(), world.resource<Membrane>().body_row);
    find_flat_pairs<MembranePairs>(world, world.column<Triangles, TriangleId>(), host, parts);
}

void find_membrane_pairs(World& world) {
    Table& bodies = world.table<Bodies>();
    const auto& membrane = world.resource<Membrane>();
    const auto element_radius = world.column<Elements, ElementRadius>();
    const MembraneSurface surface(membrane, element_radius.data());
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>(), skins = bodies.column<OuterSkin>();
    const double skin = skins[membrane.body_row];
    // least radius over the whole height, because a body may be longer than a ring is high
    std::vector<double> least(membrane.sectors, std::numeric_limits<double>::infinity());
    for (Row e = 0; e < element_radius.size(); ++e)
        least[e % membrane.sectors] = std::min(least[e % membrane.sectors], element_radius[e]);
    std::vector<EntityId> sector(membrane.sectors);
    std::iota(sector.begin(), sector.end(), EntityId{0});
    const std::vector<Row> host(membrane.sectors, membrane.body_row);
    const auto all = all_rows(sector.size());
    find_pairs<MembranePairs>(
        world, sector, host, [&](Row) -> const std::vector<Row>& { return all; },
        [&](Row b, Row s) {
            return position[b].dot(membrane.outward[s]) + radius[b] + skins[b] + skin > least[s];
        },
        [&](const Vec3& x, double r, Row s) {
            return surface.nearest(static_cast<int>(s), x.dot(membrane.outward[s]), x.z())
                       .distance < r + skin;
        });
}

} // namespace bris::detail
