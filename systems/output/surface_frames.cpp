#include "systems/output/surface_frames.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sphere.hpp"

namespace bris {

namespace {

/// The spheres of each body, by its id.
std::vector<std::vector<Ball>> balls_by_id(const World& world) {
    std::vector<std::vector<Ball>> balls(world.table<Bodies>().size());
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    for (std::size_t s = 0; s < parent.size(); ++s) balls[parent[s]].push_back(ball[s]);
    return balls;
}

} // namespace

SurfaceFrames::SurfaceFrames(const std::filesystem::path& path, const std::vector<NamedValue>& meta)
    : file_(path) {
    file_.add_meta(meta);
}

void SurfaceFrames::begin_part(const World& world, const BodyFrame& frame) {
    ids_ = frame.ids;
    radii_ = frame.radii;
    corners_.clear();
    const auto balls = balls_by_id(world);
    std::vector<std::int64_t> connectivity, id_of_corner, shape_of_corner;
    for (std::size_t b = 0; b < ids_.size(); ++b) {
        const auto first = static_cast<std::int64_t>(corners_.size());
        const auto body =
            surface_corners(balls[static_cast<std::size_t>(ids_[b])], sphere_.corners);
        corners_.insert(corners_.end(), body.begin(), body.end());
        id_of_corner.resize(corners_.size(), ids_[b]);
        shape_of_corner.resize(corners_.size(), frame.shapes.empty() ? 0 : frame.shapes[b]);
        for (const auto& triangle : sphere_.triangles)
            for (const std::int64_t corner : triangle) connectivity.push_back(first + corner);
    }
    const std::size_t cells = connectivity.size() / 3;
    file_.begin_part({{"surfaces", CellKind::triangle, cells, corners_.size()}}, corners_.size(),
                     cells, connectivity);
    const auto put = [&](const char* name, const std::vector<std::int64_t>& values) {
        file_.put({.name = name, .fixed = true}, std::span<const std::int64_t>(values));
    };
    put("id", id_of_corner);
    put("shape", shape_of_corner);
}

void SurfaceFrames::add(const World& world, const BodyFrame& frame) {
    if (!file_.has_part() || frame.ids != ids_ || frame.radii != radii_) begin_part(world, frame);
    std::vector<float> points;
    points.reserve(3 * corners_.size());
    const std::size_t each = sphere_.corners.size();
    for (std::size_t b = 0; b < ids_.size(); ++b) {
        Quat turned = Quat::Identity();
        if (!frame.orientations.empty()) {
            const float* q = frame.orientations.data() + 4 * b;
            turned = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).cast<double>().normalized();
        }
        for (std::size_t k = 0; k < each; ++k)
            append_vector(points, frame.positions[b] + turned * corners_[each * b + k]);
    }
    file_.put_points(points);
    file_.end_frame(frame.time);
}

} // namespace bris
