#pragma once

#include "engine/entity.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bris {

/// Bodies that must not move before all contacts of spheres are computed, because chunks of near
/// rows other than their own read and push them. They are noted by groups of rows.
struct LateBodies {
    static constexpr auto name = "late_bodies";
    static constexpr Row group = 8; ///< whole lanes

    struct Run {
        Row first, last;
    };
    std::vector<std::uint8_t> is_late;  ///< by group
    std::vector<Run> runs;              ///< rows of the late groups, chunk by chunk
    std::vector<std::size_t> first_run; ///< chunks + 1
};

} // namespace bris
