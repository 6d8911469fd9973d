#pragma once

#include "engine/world.hpp"

namespace bris::detail {

/// Finds the spheres of each body and the rows of the bodies that boundaries belong to. The spheres
/// of a body are contiguous, in the order of the bodies' rows.
void find_runs(World& world);

/// Brings EnlargedSphere up to date. Skin: InnerSkin or OuterSkin.
template <class Skin>
void locate_spheres(World& world);

} // namespace bris::detail
