#pragma once

#include "engine/io/run_file.hpp"
#include "engine/named_value.hpp"
#include "engine/rows_of_ranks.hpp"
#include "engine/world.hpp"
#include "systems/output/body_frame.hpp"
#include "systems/output/contact_frames.hpp"
#include "systems/output/surface_frames.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace bris {

/// What is written beside the bodies, to files of their own.
struct Extras {
    bool surfaces = false; ///< NAME_surfaces.vtkhdf, see SurfaceFrames
    bool contacts = false; ///< NAME_contacts.vtkhdf, see ContactFrames
};

/// Writes frames of a world to NAME.vtkhdf: id, shape, radius, velocity, angular velocity,
/// orientation and coordination number of every body; facets as quads. Of a divided world
/// (Simulation::observed) all ranks must add each frame. Throws OutputError.
class FrameWriter {
public:
    FrameWriter(const std::filesystem::path& path, const std::vector<NamedValue>& meta,
                const Extras& extras = {});
    void add(const World& world);
    /// A frame of the bodies of a world (frame_of_bodies), whose poses may be others than those of
    /// the world; contacts are those of the world.
    void add(const World& world, BodyFrame frame);
    std::size_t frames() const { return file_.frames(); }
    /// The file, for tracks and other data of the run.
    RunFile& file() { return file_; }

private:
    void begin_part(const RowsOfRanks& ranks, BodyFrame& frame);
    RunFile file_;
    std::optional<SurfaceFrames> surfaces_;
    std::optional<ContactFrames> contacts_;
    std::size_t hash_of_bodies_ = 0; // of the part begun last: ids and radii
    std::size_t quads_ = 0;
};

} // namespace bris
