#include "scenarios/specimens/sleeve.hpp"

#include "components/body.hpp"
#include "scenarios/specimens/scene.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Where a column stands on the prism: the sides are divided into equal parts, the first one from
/// the corner at angle 0.
Vec3 column_at(unsigned column, unsigned columns, unsigned sectors, double radius) {
    const unsigned parts = columns / sectors, side = column / parts;
    const double share = static_cast<double>(column % parts) / parts,
                 corner = radius / std::cos(pi / sectors);
    const auto at = [&](unsigned k) {
        const double angle = 2 * pi * k / sectors;
        return Vec3(corner * std::cos(angle), corner * std::sin(angle), 0);
    };
    return (1 - share) * at(side) + share * at(side + 1);
}

/// The two triangles of a field between two levels and two columns. The diagonals alternate from
/// level to level, so that every node has six triangles; where they alternate within a level, nodes
/// have four or eight, and a sleeve under pressure takes the pattern of a chessboard.
std::array<TriangleNodes, 2> triangles_of(unsigned level, unsigned column, unsigned columns) {
    const unsigned next = (column + 1) % columns;
    const EntityId a = level * columns + column, b = level * columns + next, c = b + columns,
                   d = a + columns;
    if (level % 2 == 0) return {{{{a, c, b}}, {{a, d, c}}}};
    return {{{{a, d, b}}, {{b, d, c}}}};
}

RestTriangle rest_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 one = b - a, two = c - a;
    const double along = one.norm();
    return {along, two.dot(one) / along, one.cross(two).norm() / along};
}

void add_columns(World& world, std::size_t nodes, std::size_t triangles) {
    Table& n = world.table<Nodes>();
    n.add<NodeId>();
    n.add<NodePosition>();
    n.add<NodeVelocity>();
    n.add<NodeStiffness>();
    n.add<NodeLatex>();
    n.add<NodePush>();
    n.add<NodeForce>();
    n.add<NodePressure>();
    n.add<NodeHold>();
    n.add<PrunedNode>();
    n.add<RebuiltNode>();
    n.resize(nodes);
    for (Row k = 0; k < nodes; ++k) n.column<NodeId>()[k] = k;
    Table& t = world.table<Triangles>();
    t.add<TriangleId>();
    t.add<Corners>();
    t.add<RestShape>();
    t.add<TriangleAt>();
    t.resize(triangles);
    for (Row k = 0; k < triangles; ++k) t.column<TriangleId>()[k] = k;
}

} // namespace

void add_sleeve(World& world, Membrane membrane, Sleeve sleeve, const SleeveMesh& mesh,
                std::uint32_t material) {
    membrane.body = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * mesh.radius);
    sleeve.columns = mesh.columns;
    std::vector<TriangleNodes> triangles;
    for (unsigned level = 0; level + 1 < mesh.levels; ++level)
        for (unsigned column = 0; column < mesh.columns; ++column)
            for (const TriangleNodes& t : triangles_of(level, column, mesh.columns))
                triangles.push_back(t);
    add_columns(world, std::size_t{mesh.columns} * mesh.levels, triangles.size());
    std::ranges::copy(triangles, world.column<Triangles, Corners>().begin());
    world.add_resource(std::move(membrane));
    world.add_resource(std::move(sleeve));
    put_on(world, mesh.sectors, mesh.radius, mesh.height);
}

void put_on(World& world, unsigned sectors, double radius, double height) {
    auto& sleeve = world.resource<Sleeve>();
    sleeve.radius = radius;
    sleeve.pressure_work = sleeve.clamp_work = sleeve.damping_work = 0;
    const auto position = world.column<Nodes, NodePosition>();
    const std::size_t levels = position.size() / sleeve.columns;
    for (std::size_t n = 0; n < position.size(); ++n) {
        position[n] =
            column_at(static_cast<unsigned>(n % sleeve.columns), sleeve.columns, sectors, radius);
        position[n].z() =
            height * static_cast<double>(n / sleeve.columns) / static_cast<double>(levels - 1);
        world.column<Nodes, NodeVelocity>()[n].setZero();
        world.column<Nodes, NodeStiffness>()[n] = world.column<Nodes, NodeLatex>()[n] = 0;
    }
    const auto corners = world.column<Triangles, Corners>();
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const auto& node = corners[t].node;
        const RestTriangle rest = world.column<Triangles, RestShape>()[t] =
            rest_of(position[node[0]], position[node[1]], position[node[2]]);
        for (const EntityId n : node) // a third of the triangle's mass
            world.column<Nodes, NodeLatex>()[n] +=
                sleeve.density * sleeve.thickness * rest.along * rest.high / 6;
    }
}

double sleeve_volume(const World& world) {
    const auto position = world.column<Nodes, NodePosition>();
    double volume = 0;
    for (const TriangleNodes& t : world.column<Triangles, Corners>()) {
        const Vec3 &a = position[t.node[0]], &b = position[t.node[1]], &c = position[t.node[2]],
                   area = 0.5 * (b - a).cross(c - a), middle = (a + b + c) / 3;
        volume -= 0.5 * (middle.x() * area.x() + middle.y() * area.y());
    }
    return volume;
}

std::vector<double> sleeve_radii(const World& world, std::size_t bands) {
    const auto position = world.column<Nodes, NodePosition>();
    const double top = position.back().z();
    std::vector<double> sum(bands, 0), count(bands, 0);
    for (const Vec3& x : position) {
        const double at = std::clamp(x.z() / top, 0.0, 1.0) * static_cast<double>(bands);
        const std::size_t band = std::min(bands - 1, static_cast<std::size_t>(at));
        sum[band] += std::hypot(x.x(), x.y());
        count[band] += 1;
    }
    for (std::size_t k = 0; k < bands; ++k) sum[k] /= count[k];
    return sum;
}

} // namespace bris
