#include "systems/output/body_frame.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane_surface.hpp"
#include "components/over_ranks.hpp"
#include "components/settings.hpp"
#include "components/sleeve.hpp"
#include "components/sphere.hpp"
#include "engine/io/vtkhdf_file.hpp"
#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "systems/output/contacts.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

namespace bris {

namespace {

/// Counts the bodies that each body touches, by row. A partner with several contacts counts once.
template <class Pairs>
void count_partners(const World& world, std::vector<float>& count) {
    PairNames last{nobody, nobody, 0, 0};
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& pair) {
        if (pair.names.owner != last.owner || pair.names.partner != last.partner) {
            count[pair.owner] += 1;
            count[pair.partner] += 1;
        }
        last = pair.names;
    });
}

std::vector<float> coordination_of(const World& world) {
    std::vector<float> count(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { count_partners<Pairs>(world, count); });
    return count;
}

// Positions are computed from State alone, so they are valid before the first step and after a
// restore.

void add_facet_corners(const World& world, std::vector<Vec3>& corners) {
    if (!world.has<Facets>()) return;
    const RowIndex rows(world.column<Bodies, BodyId>());
    const auto id = world.column<Facets, FacetId>();
    const auto host = world.column<Facets, HostId>();
    const auto shape = world.column<Facets, LocalFacet>();
    const Table& bodies = world.table<Bodies>();
    std::vector<Row> by_id = all_rows(shape.size());
    std::ranges::sort(by_id, {}, [&](Row f) { return id[f]; });
    for (const Row f : by_id) {
        const Row h = rows[host[f]];
        const Quat turned =
            bodies.has<Orientation>() ? bodies.column<Orientation>()[h] : Quat(Quat::Identity());
        const FacetRow at = placed(shape[f], bodies.column<Position>()[h], turned);
        corners.insert(corners.end(), at.corners.begin(), at.corners.end());
    }
}

// strips of the membrane between the middles of adjacent rings, and half a ring at each end
void add_membrane_corners(const World& world, std::vector<Vec3>& corners) {
    if (!world.has<Elements>()) return;
    const auto& membrane = world.resource<Membrane>();
    const MembraneSurface surface(membrane, world.column<Elements, ElementRadius>().data());
    // intersection of the planes of a sector and of the next one
    const auto corner = [&](int ring, int sector) {
        const int next = (sector + 1) % surface.sectors;
        const Vec3 &a = surface.outward[sector], &b = surface.outward[next];
        const double det = a.x() * b.y() - a.y() * b.x(), ra = surface.radius_at(ring, sector),
                     rb = surface.radius_at(ring, next);
        const double height =
            std::clamp(surface.middle(ring), 0.0, surface.rings * surface.ring_height);
        return Vec3((ra * b.y() - rb * a.y()) / det, (rb * a.x() - ra * b.x()) / det, height);
    };
    for (int ring = -1; ring < surface.rings; ++ring)
        for (int sector = 0; sector < surface.sectors; ++sector) {
            const int before = (sector + surface.sectors - 1) % surface.sectors;
            corners.insert(corners.end(), {corner(ring, sector), corner(ring, before),
                                           corner(ring + 1, before), corner(ring + 1, sector)});
        }
}

// a triangle repeats its last corner
void add_sleeve_corners(const World& world, std::vector<Vec3>& corners) {
    if (!world.has<Triangles>()) return;
    const auto position = world.column<Nodes, NodePosition>();
    for (const TriangleNodes& t : world.column<Triangles, Corners>())
        for (const std::size_t k : std::array<std::size_t, 4>{0, 1, 2, 2})
            corners.push_back(position[t.node[k]]);
}

std::vector<Vec3> corners_of(const World& world) {
    std::vector<Vec3> corners;
    add_facet_corners(world, corners);
    add_membrane_corners(world, corners);
    add_sleeve_corners(world, corners);
    return corners;
}

/// The rows of the bodies with spheres that count on this rank, by ascending id.
std::vector<Row> grains_by_id(const World& world) {
    const OverRanks ranks(world);
    const auto id = world.column<Bodies, BodyId>();
    const RowIndex row_of(id);
    std::vector<char> carries(id.size(), 0);
    for (const EntityId parent : world.column<Spheres, ParentId>()) carries[row_of[parent]] = 1;
    std::vector<Row> grains;
    for (Row b = 0; b < id.size(); ++b)
        if (carries[b] != 0 && ranks.counts(b)) grains.push_back(b);
    std::ranges::sort(grains, {}, [&](Row b) { return id[b]; });
    return grains;
}

} // namespace

BodyFrame frame_of_bodies(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto coordination = coordination_of(world);
    const Clock& clock = world.resource<Clock>();
    const auto velocity = bodies.column<Velocity>();
    const auto acceleration = bodies.column<Acceleration>();

    BodyFrame frame;
    frame.time = clock.time();
    const std::vector<Row> grains = grains_by_id(world);
    const auto id = bodies.column<BodyId>();
    const auto position = bodies.column<Position>(), spin = bodies.column<AngularVelocity>();
    const auto radius = bodies.column<BoundingRadius>();
    for (const Row row : grains) {
        frame.ids.push_back(id[row]);
        frame.positions.push_back(position[row]);
        frame.radii.push_back(static_cast<float>(radius[row]));
        append_vector(frame.velocities, velocity[row] + 0.5 * clock.dt * acceleration[row]);
        append_vector(frame.angular_velocities, spin[row]);
        frame.coordination.push_back(coordination[row]);
    }
    if (bodies.has<ShapeOf>())
        for (const auto shape = bodies.column<ShapeOf>(); const Row row : grains)
            frame.shapes.push_back(shape[row]);
    if (bodies.has<Orientation>())
        for (const auto turned = bodies.column<Orientation>(); const Row row : grains)
            for (const double part :
                 {turned[row].w(), turned[row].x(), turned[row].y(), turned[row].z()})
                frame.orientations.push_back(static_cast<float>(part));
    frame.corners = corners_of(world);
    return frame;
}

namespace {

/// The spheres of the bodies that have a colour, by row, and the outlines of quads.
View view_of(const World& world, const std::vector<std::optional<Colour>>& colours,
             std::span<const Vec3> corners) {
    const Table& bodies = world.table<Bodies>();
    const RowIndex row_of(bodies.column<BodyId>());
    const auto position = bodies.column<Position>();
    const Quat* orientation =
        bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    View view;
    for (std::size_t s = 0; s < ball.size(); ++s) {
        const Row row = row_of[parent[s]];
        if (!colours[row]) continue;
        Vec3 centre = ball[s].centre;
        if (orientation != nullptr) centre = orientation[row] * centre;
        view.balls.push_back({position[row] + centre, ball[s].radius, *colours[row]});
    }
    for (auto c = corners.begin(); c != corners.end(); c += 4)
        view.quads.push_back({c[0], c[1], c[2], c[3]});
    return view;
}

} // namespace

View view_of_bodies(const World& world, const BodyFrame& frame,
                    const std::function<Colour(std::size_t index)>& colour) {
    const RowIndex row_of(world.column<Bodies, BodyId>());
    std::vector<std::optional<Colour>> colours(world.table<Bodies>().size());
    for (std::size_t index = 0; index < frame.ids.size(); ++index)
        colours[row_of[static_cast<EntityId>(frame.ids[index])]] = colour(index);
    return view_of(world, colours, frame.corners);
}

View view_of_grains(const World& world,
                    const std::function<std::optional<Colour>(Row row)>& colour) {
    std::vector<std::optional<Colour>> colours(world.table<Bodies>().size());
    if (OverRanks(world).is_divided() || Ranks::is_first())
        for (const Row row : grains_by_id(world)) colours[row] = colour(row);
    return view_of(world, colours, corners_of(world));
}

View view_by_coordination(const World& world, double most) {
    const std::vector<float> coordination = coordination_of(world);
    return view_of_grains(world, [&](Row row) {
        return scale_colour(std::min(1.0, static_cast<double>(coordination[row]) / most));
    });
}

void gather(View& view) { Ranks::gather(view.balls); }

} // namespace bris
