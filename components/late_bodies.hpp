#pragma once

#include "engine/entity.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Bodies that must not move before all contacts of spheres are computed, because chunks of near
/// rows other than their own read and push them. They are noted by groups of rows. A group that
/// lies in two chunks is late and belongs to the second.
struct LateBodies {
    static constexpr auto name = "late_bodies";
    static constexpr Row group = 8; ///< whole lanes

    std::vector<std::uint8_t> is_late; ///< by group
};

} // namespace bris
