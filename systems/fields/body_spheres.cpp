#include "systems/fields/body_spheres.hpp"

#include "components/kinds.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"

#include <limits>

namespace bris {

BodySpheres spheres_of_bodies(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto id = bodies.column<BodyId>();
    BodySpheres all;
    all.row = in_order_of_ids(id);
    const auto position = bodies.column<Position>();
    const Quat* orientation =
        bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    const std::size_t n = all.row.size();

    // the spheres of a body are contiguous
    std::vector<EntityId> ids(n);
    for (std::size_t b = 0; b < n; ++b) ids[b] = id[all.row[b]];
    const RowIndex number_of(ids);
    std::vector<Row> count(n), from(n);
    for (Row k = 0; k < parent.size(); ++k)
        if (const Row b = number_of[parent[k]]; count[b]++ == 0) from[b] = k;
    all.first.assign(n + 1, 0);
    for (std::size_t b = 0; b < n; ++b) all.first[b + 1] = all.first[b] + count[b];
    all.spheres.resize(parent.size());
    all.box.resize(n);
    all.pose.resize(n);
    for_chunks(n, 64, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const Row r = all.row[b];
            all.pose[b] = {position[r],
                           orientation != nullptr ? orientation[r] : Quat(Quat::Identity())};
            const Mat3 axes = all.pose[b].orientation.toRotationMatrix();
            Box3 box{Vec3::Constant(std::numeric_limits<double>::infinity()),
                     Vec3::Constant(-std::numeric_limits<double>::infinity())};
            for (Row k = 0; k < count[b]; ++k) {
                const Ball& local = ball[from[b] + k];
                const Vec3 x = all.pose[b].position + axes * local.centre;
                all.spheres[all.first[b] + k] = {x.x(), x.y(), x.z(), local.radius};
                box.low = box.low.cwiseMin(x - Vec3::Constant(local.radius));
                box.high = box.high.cwiseMax(x + Vec3::Constant(local.radius));
            }
            all.box[b] = box;
        }
    });
    return all;
}

} // namespace bris
