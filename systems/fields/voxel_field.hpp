#pragma once

#include "systems/fields/voxels.hpp"

#include <memory>

namespace bris {

/// A number for every voxel of a set of blocks, held in an OpenVDB grid. Copies are deep.
class VoxelField {
public:
    VoxelField();
    /// Zeros on all voxels of the blocks.
    explicit VoxelField(const VoxelBlocks& blocks);
    VoxelField(const VoxelField& other);
    VoxelField(VoxelField&& other) noexcept;
    VoxelField& operator=(const VoxelField& other);
    VoxelField& operator=(VoxelField&& other) noexcept;
    ~VoxelField();

    std::size_t blocks() const { return block_.size(); }
    std::size_t size() const { return block_.size() * VoxelBlocks::voxels_each; }
    /// The 512 values of a block.
    double* block(std::size_t b) { return block_[b]; }
    const double* block(std::size_t b) const { return block_[b]; }
    /// The value of a voxel by its number (VoxelBlocks).
    double& operator[](std::uint32_t number) {
        return block_[number / VoxelBlocks::voxels_each][number % VoxelBlocks::voxels_each];
    }
    double operator[](std::uint32_t number) const {
        return block_[number / VoxelBlocks::voxels_each][number % VoxelBlocks::voxels_each];
    }
    /// Sum of all values, in the order of the voxels.
    double sum() const;

private:
    struct Grid;
    std::unique_ptr<Grid> grid_;
    std::vector<double*> block_; // buffers of the grid's leaf nodes
};

/// The values of `field`, which belongs to `from`, on other blocks: zero where it has none.
VoxelField on_blocks(const VoxelField& field, const VoxelBlocks& from, const VoxelBlocks& to);

} // namespace bris
