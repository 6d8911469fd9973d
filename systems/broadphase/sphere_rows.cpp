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
constexpr std::size_t rows_per_chunk = 1024;
}

void find_runs(World& world) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const auto parent = spheres.column<ParentId>();
    const auto row_of = rows_by_id(bodies.column<BodyId>());
    for_chunks(run.size(), rows_per_chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) run[b] = {};
    });
    for_chunks(parent.size(), rows_per_chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (k > 0 && parent[k] == parent[k - 1]) continue; // not the first of its body
            std::size_t last = k + 1;
            while (last < parent.size() && parent[last] == parent[k]) ++last;
            SphereRun& r = run[row_of[parent[k]]];
            r.first = static_cast<Row>(k);
            r.count = static_cast<Row>(last - k);
        }
    });
    if (world.has<Planes>()) {
        const auto host = world.column<Planes, HostId>();
        const auto row = world.column<Planes, HostRow>();
        for (std::size_t i = 0; i < host.size(); ++i) row[i] = row_of[host[i]];
    }
    if (world.has<Facets>()) {
        const auto host = world.column<Facets, HostId>();
        const auto row = world.column<Facets, HostRow>();
        for (std::size_t i = 0; i < host.size(); ++i) row[i] = row_of[host[i]];
    }
    if (world.has<Elements>())
        world.resource<Membrane>().body_row = row_of[world.resource<Membrane>().body];
}

template <class Skin>
void locate_spheres(World& world) {
    const Table& bodies = world.table<Bodies>();
    Table& spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const auto position = bodies.column<Position>();
    const Quat* orientation =
        bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    const auto skin = bodies.column<Skin>();
    const auto ball = spheres.column<LocalBall>();
    const auto sphere_row = spheres.column<EnlargedSphere>();
    for_chunks(
        bodies.size(), rows_per_chunk / 4, [&](std::size_t, std::size_t begin, std::size_t end) {
            for (auto b = static_cast<Row>(begin); b < end; ++b) {
                const Mat3 axes = (orientation != nullptr ? orientation[b] : Quat(Quat::Identity()))
                                      .toRotationMatrix();
                for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) {
                    const Vec3 x = position[b] + axes * ball[k].centre;
                    sphere_row[k] = {x.x(), x.y(), x.z(), ball[k].radius + skin[b]};
                }
            }
        });
}
template void locate_spheres<InnerSkin>(World&);
template void locate_spheres<OuterSkin>(World&);

} // namespace bris::detail
