#include "systems/broadphase/sphere_rows.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"

namespace bris::detail {

namespace {

template <class Boundary>
void find_hosts(World& world, const RowIndex& row_of) {
    if (!world.has<Boundary>()) return;
    const auto host = world.column<Boundary, HostId>();
    const auto row = world.column<Boundary, HostRow>();
    for (std::size_t i = 0; i < host.size(); ++i) row[i] = row_of[host[i]];
}

} // namespace

template <class At, class Turned>
void note_poses(World& world) {
    const auto position = world.column<Bodies, Position>(), at = world.column<Bodies, At>();
    for_rows(at.size(), [&](Row b) { at[b] = position[b]; });
    if (!world.table<Bodies>().has<Turned>()) return;
    const auto orientation = world.column<Bodies, Orientation>(),
               turned = world.column<Bodies, Turned>();
    for_rows(turned.size(), [&](Row b) { turned[b] = orientation[b]; });
}
template void note_poses<PrunedAt, PrunedOrientation>(World&);
template void note_poses<RebuiltAt, RebuiltOrientation>(World&);

void find_runs(World& world) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const auto parent = spheres.column<ParentId>();
    const RowIndex row_of(bodies.column<BodyId>());
    for_rows(run.size(), [&](Row b) { run[b] = {}; });
    for_rows(parent.size(), [&](Row k) {
        if (k > 0 && parent[k] == parent[k - 1]) return; // not the first of its body
        Row last = k + 1;
        while (last < parent.size() && parent[last] == parent[k]) ++last;
        SphereRun& r = run[row_of[parent[k]]];
        r.first = k;
        r.count = last - k;
    });
    find_hosts<Planes>(world, row_of);
    find_hosts<Facets>(world, row_of);
    if (world.has_resource<Membrane>())
        world.resource<Membrane>().body_row = row_of[world.resource<Membrane>().body];
}

template <class Skin>
void locate_spheres(World& world) {
    const Table& bodies = world.table<Bodies>();
    Table& spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const Poses<> poses(world);
    const auto skin = bodies.column<Skin>();
    const auto ball = spheres.column<LocalBall>();
    const auto sphere_row = spheres.column<EnlargedSphere>();
    for_chunks(bodies.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (auto b = static_cast<Row>(begin); b < end; ++b) {
            const Pose pose = poses[b];
            const Mat3 axes = pose.orientation.toRotationMatrix();
            for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) {
                const Vec3 x = pose.position + axes * ball[k].centre;
                sphere_row[k] = {x.x(), x.y(), x.z(), ball[k].radius + skin[b]};
            }
        }
    });
}
template void locate_spheres<InnerSkin>(World&);
template void locate_spheres<OuterSkin>(World&);

} // namespace bris::detail
