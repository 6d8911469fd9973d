#pragma once

#include "systems/fields/fouling.hpp"

namespace bris {

/// Mass of fines (kg) that each voxel can hold: its voids filled with compacted fines.
VoxelField fines_capacity(const Fouling& fouling);

/// Volume of water (m3) that each voxel can hold: the voids that its fines leave.
VoxelField water_capacity(const Fouling& fouling);

} // namespace bris
