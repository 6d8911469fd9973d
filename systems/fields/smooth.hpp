#pragma once

#include "systems/fields/voxel_field.hpp"

namespace bris {

/// The field spread by a kernel that falls linearly to zero at `half_width` + 1 voxels along each
/// axis (a product of three tents). Sums are kept, except for what would go to voxels outside the
/// blocks. `half_width` >= 0; 0: the field itself.
VoxelField smoothed(const VoxelField& field, const VoxelBlocks& blocks, int half_width);

/// The blocks and all others within `voxels` of one of theirs.
VoxelBlocks widened(const VoxelBlocks& blocks, int voxels);

} // namespace bris
