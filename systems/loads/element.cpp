#include "systems/loads/element.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

void require_clumps(const World& world, const char* what) {
    require(world.table<Bodies>().has<Orientation>(),
            fmt::format("{}: expected a scene of clumps, found one of single spheres, whose bodies "
                        "have no orientation",
                        what));
}

Row row_of_free_clump(const World& world, EntityId body, const char* what) {
    require_clumps(world, what);
    const auto ids = world.column<Bodies, BodyId>();
    const auto row = static_cast<Row>(std::ranges::find(ids, body) - ids.begin());
    require(row < ids.size(),
            fmt::format("{}: expected a body of the scene, found none with id {}", what, body));
    require(world.column<Bodies, MotionOf>()[row] == static_cast<std::uint32_t>(Motion::free),
            fmt::format("{}: expected a free body, found body {}, which is driven", what, body));
    return row;
}

} // namespace bris
