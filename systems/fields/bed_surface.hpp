#pragma once

#include "systems/fields/voxel_field.hpp"

namespace bris {

/// Sets `shown` to 0 in the voxels above the surface of the bed: a container reaches to the highest
/// rock, so that over a slope it holds air. The surface lies over the highest voxels with rocks
/// (`solid`), column by column, and spans dips between rocks, which are narrower than twice
/// `half_width` voxels (the closing of their heights): it follows a slope, and leaves no void of
/// the bed out.
void hide_air_above(VoxelField& shown, const VoxelField& solid, const VoxelBlocks& blocks,
                    int half_width);

} // namespace bris
