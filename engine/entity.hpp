#pragma once

#include <cstdint>
#include <limits>

namespace bris {

/// A thing of the scene: counted up from 0 within its kind, not reused while things are only added.
/// Files, options and components store ids; rows are where a thing happens to be now.
using EntityId = std::uint32_t;

/// A position in a table now; valid until the next refresh of the pair lists.
using Row = std::uint32_t;

inline constexpr EntityId nobody = std::numeric_limits<EntityId>::max();
inline constexpr Row no_row = std::numeric_limits<Row>::max();

} // namespace bris
