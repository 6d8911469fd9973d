#pragma once

#include "systems/fields/voxel_field.hpp"

namespace bris {

/// The largest power of two with which a sum up to `total` is exact: amounts that are multiples of
/// it can be added and moved in any order without rounding.
double exact_unit(double total);
/// The largest multiple of `unit`, a power of two, that is not above x >= 0.
inline double floor_to(double unit, double x) { return std::floor(x / unit) * unit; }

/// Moves what is beyond the capacity of its voxel, as when a rock has entered it, to the nearest
/// voxels with free capacity, shell by shell, in proportion to what they can hold. All amounts are
/// multiples of `unit`, so their sum stays the same to the last bit. Voxels are visited in their
/// order. Returns what found no place within ten voxels and
/// therefore stays where it is.
double displace_excess(VoxelField& amount, const VoxelBlocks& blocks, const VoxelField& capacity,
                       double unit);

} // namespace bris
