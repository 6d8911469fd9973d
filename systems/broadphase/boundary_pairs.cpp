#include "components/boundary.hpp"
#include "components/material.hpp"
#include "components/membrane_surface.hpp"
#include "systems/broadphase/carry_over.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace bris::detail {

namespace {

// candidates of every free body with every boundary part (plane, facet, sector of a membrane) that
// `near_body` and `near_sphere` let through, ordered by (host id, sphere, part id)
template <class Pairs, class NearBody, class NearSphere>
void find_pairs(World& world, std::span<const EntityId> part, std::span<const Row> host,
                NearBody&& near_body, NearSphere&& near_sphere) {
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto run = bodies.column<SpheresOf>();
    const auto id = bodies.column<BodyId>();
    const auto material = bodies.column<MaterialOf>();
    const auto place = world.column<Spheres, SpherePlace>();
    const auto& materials = world.resource<Materials>();
    ChunkLists<Candidate> found;
    std::vector<Row> first;
    found.collect(bodies.size(), first, [&](std::vector<Candidate>& list, Row b) {
        if (run[b].count == 0 || motion[b] != static_cast<std::uint32_t>(Motion::free)) return;
        const std::size_t begin = list.size();
        for (Row e = 0; e < part.size(); ++e) {
            if (!near_body(b, e)) continue;
            const std::uint32_t law = materials.pair(material[b], material[host[e]]);
            for (Row k = run[b].first; k < run[b].first + run[b].count; ++k)
                if (near_sphere(centre_of(place[k]), place[k].radius, e))
                    list.push_back({{id[b], id[host[e]], k - run[b].first, part[e]}, {k, e, host[e], law}});
        }
        std::sort(list.begin() + static_cast<std::ptrdiff_t>(begin), list.end(),
                  [](const Candidate& x, const Candidate& y) { return x.names < y.names; });
    });
    replace_pairs<Pairs>(world, found, first);
}

} // namespace

void find_plane_pairs(World& world, double skin) {
    Table &planes = world.table<Planes>(), &bodies = world.table<Bodies>();
    const auto host = planes.column<HostRow>();
    const auto shape = planes.column<LocalPlane>();
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto height = [&](const Vec3& x, Row e) {
        return (x - position[host[e]] - shape[e].point).dot(shape[e].normal);
    };
    find_pairs<PlanePairs>(
        world, planes.column<PlaneId>(), host,
        [&](Row b, Row e) { return height(position[b], e) < radius[b] + skin; },
        [&](const Vec3& x, double r, Row e) { return height(x, e) < r + skin; });
}

void find_facet_pairs(World& world, double skin) {
    Table &facets = world.table<Facets>(), &bodies = world.table<Bodies>();
    const auto host = facets.column<HostRow>();
    const auto shape = facets.column<LocalFacet>();
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>();
    std::vector<Eigen::AlignedBox3d> boxes(facets.size());
    for (std::size_t e = 0; e < boxes.size(); ++e)
        for (const Vec3& corner : shape[e].corners)
            boxes[e].extend(Eigen::Vector3d(position[host[e]] + corner));
    std::vector<Vec3> normal(facets.size());
    for (std::size_t e = 0; e < normal.size(); ++e) {
        const auto& c = shape[e].corners;
        normal[e] = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    }
    // beyond the facet's box, or beyond its plane: each alone is far enough
    const auto reaches = [&](const Vec3& x, double r, Row e) {
        const double height = (x - position[host[e]] - shape[e].corners[0]).dot(normal[e]);
        return std::abs(height) < r + skin &&
               boxes[e].squaredExteriorDistance(Eigen::Vector3d(x)) < (r + skin) * (r + skin);
    };
    find_pairs<FacetPairs>(
        world, facets.column<FacetId>(), host,
        [&](Row b, Row e) { return reaches(position[b], radius[b], e); }, reaches);
}

void find_membrane_pairs(World& world, double skin) {
    Table& bodies = world.table<Bodies>();
    const auto& membrane = world.resource<Membrane>();
    const auto element_radius = world.column<Elements, ElementRadius>();
    const MembraneSurface surface(membrane, element_radius.data());
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>();
    // of the whole height: a body may be longer than a ring is high
    std::vector<double> least(membrane.sectors, std::numeric_limits<double>::infinity());
    for (Row e = 0; e < element_radius.size(); ++e)
        least[e % membrane.sectors] = std::min(least[e % membrane.sectors], element_radius[e]);
    std::vector<EntityId> sector(membrane.sectors);
    std::iota(sector.begin(), sector.end(), EntityId{0});
    const std::vector<Row> host(membrane.sectors, membrane.body_row);
    find_pairs<MembranePairs>(
        world, sector, host,
        [&](Row b, Row s) { return position[b].dot(membrane.outward[s]) + radius[b] + skin > least[s]; },
        [&](const Vec3& x, double r, Row s) {
            return surface.nearest(static_cast<int>(s), x.dot(membrane.outward[s]), x.z()).distance < r + skin;
        });
}

} // namespace bris::detail
