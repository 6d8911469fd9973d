#pragma once

#include "engine/io/vtkhdf_file.hpp"
#include "engine/world.hpp"
#include "systems/output/body_frame.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// Frames of all contacts as lines (force chains): from the centre of the owner to that of the
/// partner, or to the point of contact with a boundary. A line has `normal_force` and `shear_force`
/// (N), `force` on the owner (N), `overlap` and `point` (m), `owner` and `partner` (ids of bodies),
/// and `kind` (index in contact_kinds). Several contacts of two clumps share their ends. Throws
/// OutputError.
class ContactFrames {
public:
    ContactFrames(const std::filesystem::path& path, const std::vector<NamedValue>& meta);
    /// The contacts of a world, between the bodies of its frame.
    void add(const World& world, const BodyFrame& frame);

private:
    VtkhdfFile file_;
};

} // namespace bris
