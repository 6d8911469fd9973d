#pragma once

#include "engine/io/vtkhdf_file.hpp"
#include "engine/world.hpp"
#include "systems/output/body_frame.hpp"
#include "systems/output/surfaces.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace bris {

/// Frames of the surfaces of all bodies with spheres as triangles, with the `id` and the `shape` of
/// the body at each corner. A body has 642 corners, 8 kB in each frame. Throws OutputError.
class SurfaceFrames {
public:
    SurfaceFrames(const std::filesystem::path& path, const std::vector<NamedValue>& meta);
    /// The bodies of a frame, whose spheres are those of the world.
    void add(const World& world, const BodyFrame& frame);

private:
    void begin_part(const World& world, const BodyFrame& frame);

    VtkhdfFile file_;
    TriangulatedSphere sphere_{3};
    std::vector<std::int64_t> ids_; // of the part begun last
    std::vector<float> radii_;
    std::vector<Vec3> corners_; // m, in the axes of the bodies, one body after the other
};

} // namespace bris
