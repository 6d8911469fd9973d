#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane_surface.hpp"
#include "components/over_ranks.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "components/triangle_surface.hpp"
#include "engine/errors.hpp"
#include "engine/ranks.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/facet_geometry.hpp"

#include <fmt/format.h>

#include <cstring>

namespace bris {

namespace {

struct Deepest {
    double ratio = 0;   ///< overlap over the mean radius
    double overlap = 0; ///< m
    PairNames names{nobody, nobody, 0, 0};

    void consider(const PairNames& who, double found, double radius) {
        if (!(found > ratio * radius)) return;
        ratio = found / radius;
        overlap = found;
        names = who;
    }
};

/// Distance (m) of the centre of a sphere from a boundary element; negative behind a plane or the
/// membrane.
double distance_from_plane(const World& world, Row plane, Row host, const Vec3& x) {
    const PlaneShape& shape = world.column<Planes, LocalPlane>()[plane];
    return (x - world.column<Bodies, Position>()[host] - shape.point).dot(shape.normal);
}

double distance_from_facet(const World& world, Row facet, Row host, const Vec3& x) {
    const Table& bodies = world.table<Bodies>();
    const Quat turned =
        bodies.has<Orientation>() ? bodies.column<Orientation>()[host] : Quat(Quat::Identity());
    const FacetRow at =
        placed(world.column<Facets, LocalFacet>()[facet], bodies.column<Position>()[host], turned);
    return std::abs(detail::nearest_on_mesh_facet(at, x).distance);
}

double distance_from_membrane(const World& world, Row sector, const Vec3& x) {
    if (world.has<Triangles>()) {
        const auto position = world.column<Nodes, NodePosition>();
        return distance_from_triangle(
            placed(world.column<Triangles, Corners>()[sector],
                   [&](EntityId n) -> const Vec3& { return position[n]; }),
            x);
    }
    const auto& membrane = world.resource<Membrane>();
    const MembraneSurface surface(membrane, world.column<Elements, ElementRadius>().data());
    return surface.nearest(static_cast<int>(sector), x.dot(membrane.outward[sector]), x.z())
        .distance;
}

template <class Pairs>
void find_deepest(const World& world, Deepest& deepest) {
    if (!world.has<Pairs>()) return;
    const auto names = world.column<Pairs, PairKey>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto ball = world.column<Spheres, LocalBall>();
    for (std::size_t k = 0; k < names.size(); ++k) {
        const double radius = ball[rows[k].sphere].radius;
        const Vec3 x = detail::centre_of(sphere_row[rows[k].sphere]);
        if constexpr (std::is_same_v<Pairs, SpherePairs>) {
            const double reach = radius + ball[rows[k].other].radius;
            const Vec3 other = detail::centre_of(sphere_row[rows[k].other]);
            deepest.consider(names[k], reach - (x - other).norm(), reach / 2);
        } else {
            double distance = 0;
            if constexpr (std::is_same_v<Pairs, PlanePairs>)
                distance = distance_from_plane(world, rows[k].other, rows[k].partner_body, x);
            else if constexpr (std::is_same_v<Pairs, FacetPairs>)
                distance = distance_from_facet(world, rows[k].other, rows[k].partner_body, x);
            else
                distance = distance_from_membrane(world, rows[k].other, x);
            deepest.consider(names[k], radius - distance, radius);
        }
    }
}

/// The deepest overlap of all ranks.
Deepest deepest_of_ranks(const Deepest& here) {
    Ranks::Bytes bytes(sizeof here);
    std::memcpy(bytes.data(), &here, sizeof here);
    Deepest deepest;
    for (const Ranks::Bytes& from : Ranks::share(bytes)) {
        Deepest there;
        std::memcpy(&there, from.data(), sizeof there);
        if (there.ratio > deepest.ratio) deepest = there;
    }
    return deepest;
}

} // namespace

void check_overlaps(World& world) {
    rebuild_pairs(world);
    Deepest deepest;
    for_each_kind_of_pair([&]<class Pairs>() { find_deepest<Pairs>(world, deepest); });
    if (OverRanks(world).is_divided()) deepest = deepest_of_ranks(deepest);
    invalidate_lists(world);
    const double limit = world.resource<Limits>().overlap;
    require(deepest.ratio <= limit,
            fmt::format("bodies {} and {}: overlap at the start: expected at most {:g} of the mean "
                        "radius, found {:.4g} ({:.4g} m); "
                        "start them farther apart, or relax the overlaps",
                        deepest.names.owner, deepest.names.partner, limit, deepest.ratio,
                        deepest.overlap));
}

} // namespace bris
