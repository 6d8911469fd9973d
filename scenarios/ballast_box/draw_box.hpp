#pragma once

#include "engine/world.hpp"

#include <filesystem>
#include <string>

namespace bris {

/// Draws the rocks that lie in a box, its ties, bladder and subgrade; sensor rocks in red.
void draw_box(const World& world, const std::filesystem::path& png, const std::string& caption);

} // namespace bris
