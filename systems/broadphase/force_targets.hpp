#pragma once

#include "components/pair.hpp"
#include "engine/world.hpp"

namespace bris::detail {

/// Divides the near rows of a kind of pair into chunks of whole bodies, and marks all pairs as
/// touching, so that the next step clears those that do not touch. The division depends on the
/// number of threads; no result does.
template <class Pairs>
void divide_into_chunks(World& world);

/// Determines where the forces on the partners of all near rows are added: in the sum of the
/// partner if the same chunk owns it, otherwise in a row of its list (ForceSums).
void direct_forces(World& world);

} // namespace bris::detail
