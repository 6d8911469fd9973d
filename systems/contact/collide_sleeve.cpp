#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/settings.hpp"
#include "components/triangle_surface.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/scalar_tile.hpp"
#include "systems/contact/smooth_contacts.hpp"

namespace bris {

namespace {

using detail::TileTarget;

/// Each triangle within reach carries a force of its own, so that forces derive from one potential
/// and do not jump where a sphere goes from one triangle to the next.
struct Cloth {
    detail::Movers movers;
    const PlacedTriangle* at;     // by triangle
    const TriangleNodes* corners; // by triangle
    const Vec3* velocity;         // by node
    Tread* tread;                 // by near row
    Vec3 centre;                  // of the sleeve's body
    double deepest;
};

/// Keeps the forces of contacts for the nodes.
struct TreadReader {
    Tread* tread;
    void operator()(const Row* rows, int count, const ForceLanes& force, unsigned left_out) const {
        for (int q = 0; q < count; ++q) {
            Vec3& on_triangle = tread[rows[q]].force;
            on_triangle.setZero();
            if (((left_out >> q) & 1) == 0)
                on_triangle = Vec3(-force.x[q], -force.y[q], -force.z[q]);
        }
    }
};

/// lane_count near rows from `row` on: bits of those that touch, and their nearest points.
struct Found {
    unsigned touching;
    NearestOnTriangle nearest;
};

Found find_touching(const Cloth& cloth, const NearEntry* near) {
    const auto c =
        transpose(load_rows([&](int q) { return &cloth.movers.sphere_row[near[q].owner].x; }));
    Found f;
    f.nearest = nearest_on_triangle(
        triangle_lanes([&](int q) -> const PlacedTriangle& { return cloth.at[near[q].other]; }),
        {c[0], c[1], c[2]});
    f.touching = bits(f.nearest.distance < c[3]);
    return f;
}

template <class Law>
void add_touching(const Found& found, unsigned touching, const Cloth& cloth, const TileTarget& to,
                  Row first, detail::ScalarTile<Law, TreadReader>& tile) {
    const NearestOnTriangle& n = found.nearest;
    for (; touching != 0; touching &= touching - 1) {
        const int k = __builtin_ctz(touching);
        const Row row = first + static_cast<Row>(k);
        const auto& node = cloth.corners[to.near[row].other].node;
        const Vec3 share(n.share[0][k], n.share[1][k], n.share[2][k]);
        cloth.tread[row].share = share;
        const Vec3 velocity = share[0] * cloth.velocity[node[0]] +
                              share[1] * cloth.velocity[node[1]] +
                              share[2] * cloth.velocity[node[2]];
        tile.add(row, Vec3(n.normal.x[k], n.normal.y[k], n.normal.z[k]), n.distance[k],
                 {velocity, Vec3::Zero(), cloth.centre});
    }
}

template <class Law>
void collide_chunk(const TileTarget& to, const Cloth& cloth, NearIndex<MembranePairs>& index,
                   std::size_t chunk) {
    const NearChunk& here = index.chunks[chunk];
    detail::ScalarTile<Law, TreadReader> tile(to, cloth.movers, cloth.deepest,
                                              index.beyond_limit[chunk], {cloth.tread});
    for (Row group = here.first; group < here.last; group += 8) {
        const unsigned valid = here.last - group < 8 ? (1u << (here.last - group)) - 1 : 0xff;
        unsigned now = 0;
        for (unsigned lane = 0; lane < 8; lane += lane_count) {
            const Found found = find_touching(cloth, to.near + group + lane);
            const unsigned touching = found.touching & (valid >> lane);
            add_touching(found, touching, cloth, to, group + lane, tile);
            now |= touching << lane;
        }
        index.touching[here.first_flags + (group - here.first) / 8] =
            static_cast<std::uint8_t>(now);
    }
    tile.flush();
}

template <class Law, class... Work>
void collide(Rows<NearMembrane, const NearPair, const PartnerSum, PairForce, TreadOf> near,
             detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
             Rows<Bodies, const Position> positions, Rows<Nodes, const NodeVelocity> nodes,
             Rows<Triangles, const Corners, const TriangleAt> triangles,
             NearIndex<MembranePairs>& index, const Membrane& membrane,
             Rows<ForceSums, ContactSum> force_sums, const ForceGrid& grid,
             const Materials& materials, const Limits& limits, const Observation& observation,
             const Clock& clock) {
    const TileTarget to =
        detail::target_of<Law>(near, Rows<MembranePairs>({}, 0, {}), bodies,
                               {force_sums, grid, materials, limits, observation, clock});
    const Cloth cloth{
        {listed, bodies, index},         triangles.column<TriangleAt>(),
        triangles.column<Corners>(),     nodes.column<NodeVelocity>(),
        near.template column<TreadOf>(), positions.column<Position>()[membrane.body_row],
        limits.overlap_of_contacts()};
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        collide_chunk<Law>(to, cloth, index, chunk);
    });
}

} // namespace

System collide_sleeve(LawName law, const StepChoices& choices) {
    return system_of_smooth_law(law, choices, []<class Smooth, class... Work>() {
        return system("collide_sleeve", collide<Smooth, Work...>);
    });
}

} // namespace bris
