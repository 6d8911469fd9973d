#include "systems/output/body_frame.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane_surface.hpp"
#include "components/settings.hpp"
#include "components/sleeve.hpp"
#include "components/sphere.hpp"
#include "engine/io/vtkhdf_file.hpp"
#include "engine/ordering.hpp"
#include "systems/output/contacts.hpp"

#include <algorithm>
#include <optional>

namespace bris {

namespace {

/// Counts the bodies that each body touches, by id. A partner with several contacts counts once.
template <class Pairs>
void count_partners(const World& world, std::vector<float>& count) {
    PairNames last{nobody, nobody, 0, 0};
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& pair) {
        if (pair.names.owner != last.owner || pair.names.partner != last.partner) {
            count[pair.names.owner] += 1;
            count[pair.names.partner] += 1;
        }
        last = pair.names;
    });
}

std::vector<float> coordination_by_id(const World& world) {
    std::vector<float> count(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { count_partners<Pairs>(world, count); });
    return count;
}

// Positions are computed from State alone, so they are valid before the first step and after a
// restore.

void add_facet_corners(const World& world, const std::vector<Row>& rows,
                       std::vector<Vec3>& corners) {
    if (!world.has<Facets>()) return;
    const auto id = world.column<Facets, FacetId>();
    const auto host = world.column<Facets, HostId>();
    const auto shape = world.column<Facets, LocalFacet>();
    const Table& bodies = world.table<Bodies>();
    corners.resize(4 * shape.size());
    for (std::size_t f = 0; f < shape.size(); ++f) {
        const Row h = rows[host[f]];
        const Quat turned =
            bodies.has<Orientation>() ? bodies.column<Orientation>()[h] : Quat(Quat::Identity());
        const FacetRow at = placed(shape[f], bodies.column<Position>()[h], turned);
        for (std::size_t k = 0; k < 4; ++k) corners[4 * id[f] + k] = at.corners[k];
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

} // namespace

BodyFrame frame_of_bodies(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto coordination = coordination_by_id(world);
    std::vector<char> carries(rows.size(), 0);
    for (const EntityId parent : world.column<Spheres, ParentId>()) carries[parent] = 1;
    const Clock& clock = world.resource<Clock>();
    const auto velocity = bodies.column<Velocity>();
    const auto acceleration = bodies.column<Acceleration>();

    BodyFrame frame;
    frame.time = clock.time();
    for (EntityId id = 0; id < rows.size(); ++id) {
        if (carries[id] == 0) continue;
        const Row row = rows[id];
        frame.ids.push_back(id);
        frame.positions.push_back(bodies.column<Position>()[row]);
        frame.radii.push_back(static_cast<float>(bodies.column<BoundingRadius>()[row]));
        append_vector(frame.velocities, velocity[row] + 0.5 * clock.dt * acceleration[row]);
        append_vector(frame.angular_velocities, bodies.column<AngularVelocity>()[row]);
        frame.coordination.push_back(coordination[id]);
        if (bodies.has<ShapeOf>()) frame.shapes.push_back(bodies.column<ShapeOf>()[row]);
        if (!bodies.has<Orientation>()) continue;
        const Quat& q = bodies.column<Orientation>()[row];
        for (const double part : {q.w(), q.x(), q.y(), q.z()})
            frame.orientations.push_back(static_cast<float>(part));
    }
    add_facet_corners(world, rows, frame.corners);
    add_membrane_corners(world, frame.corners);
    add_sleeve_corners(world, frame.corners);
    return frame;
}

View view_of_bodies(const World& world, const BodyFrame& frame,
                    const std::function<Colour(std::size_t index)>& colour) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    std::vector<std::optional<Colour>> colours(rows.size());
    for (std::size_t index = 0; index < frame.ids.size(); ++index)
        colours[static_cast<std::size_t>(frame.ids[index])] = colour(index);
    const Table& bodies = world.table<Bodies>();
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    View view;
    for (std::size_t s = 0; s < ball.size(); ++s) {
        if (!colours[parent[s]]) continue;
        const Row row = rows[parent[s]];
        Vec3 centre = ball[s].centre;
        if (bodies.has<Orientation>()) centre = bodies.column<Orientation>()[row] * centre;
        view.balls.push_back(
            {bodies.column<Position>()[row] + centre, ball[s].radius, *colours[parent[s]]});
    }
    for (std::size_t q = 0; q < frame.quads(); ++q)
        view.quads.push_back({frame.corners[4 * q], frame.corners[4 * q + 1],
                              frame.corners[4 * q + 2], frame.corners[4 * q + 3]});
    return view;
}

View view_by_coordination(const World& world, double most) {
    const BodyFrame frame = frame_of_bodies(world);
    return view_of_bodies(world, frame, [&](std::size_t index) {
        return scale_colour(std::min(1.0, static_cast<double>(frame.coordination[index]) / most));
    });
}

} // namespace bris
