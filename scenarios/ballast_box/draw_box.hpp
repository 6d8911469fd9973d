#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Draws the rocks that lie in a box, its ties, bladder and subgrade; sensor rocks in red.
void draw_box(const World& world, const std::filesystem::path& png, const std::string& caption);

/// Draws the rocks in the colours of the ranks by which they are computed.
void draw_ranks(const World& world, const std::filesystem::path& png);

/// Positions (m) of all bodies, in the order in which frames have them.
std::vector<Vec3> positions_in_frame(const World& world);
/// Draws the rocks that lie in a box in colours of their displacement from `before` (m), of which 1
/// is that of the 95th percentile. `since` completes the caption.
void draw_displacements(const World& world, const std::vector<Vec3>& before,
                        const std::filesystem::path& png, const std::string& since);

} // namespace bris
