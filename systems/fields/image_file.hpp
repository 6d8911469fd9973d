#pragma once

#include "systems/fields/vdb_file.hpp"

namespace bris {

/// Writes fields to NAME.vtkhdf as VTKHDF ImageData, which ParaView opens: one point per voxel, in
/// the smallest box around the voxels shown, single precision; voxels that are not shown have 0. A
/// vector is written as three arrays NAME_x, NAME_y, NAME_z. Throws OutputError.
void write_image(const std::filesystem::path& path, const VoxelBlocks& blocks,
                 const std::vector<FieldToWrite>& fields, double time,
                 const std::vector<NamedValue>& meta);

/// Corners of the voxels that a field shows (values other than 0); low > high: none.
struct VoxelRange {
    Voxel low{1, 1, 1}, high{0, 0, 0};
    bool empty() const { return low.x > high.x; }
    std::size_t size(int axis) const;
};
VoxelRange shown_range(const VoxelBlocks& blocks, const VoxelField& shown);

} // namespace bris
