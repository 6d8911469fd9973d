#pragma once

#include <cstdint>
#include <limits>

namespace bris {

/// Permanent number of an entity (a body, a sphere, a facet, ...). Ids count up from 0 within each
/// kind and are not reused while entities are only added. Files, options and components store ids;
/// a row is the entity's current position in memory.
using EntityId = std::uint32_t;

/// Current position of an entity in its table; valid until new pair lists are due.
using Row = std::uint32_t;

inline constexpr EntityId nobody = std::numeric_limits<EntityId>::max();
inline constexpr Row no_row = std::numeric_limits<Row>::max();

} // namespace bris
