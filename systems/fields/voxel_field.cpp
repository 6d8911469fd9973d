#include "systems/fields/voxel_field.hpp"

#include <openvdb/openvdb.h>

#include <algorithm>

namespace bris {

struct VoxelField::Grid {
    openvdb::DoubleTree tree{0.0}; // copied with all its values
};

VoxelField::VoxelField() = default;
VoxelField::~VoxelField() = default;
VoxelField::VoxelField(VoxelField&& other) noexcept = default;
VoxelField& VoxelField::operator=(VoxelField&& other) noexcept = default;

VoxelField::VoxelField(const VoxelBlocks& blocks) : grid_(std::make_unique<Grid>()) {
    static_assert(openvdb::DoubleTree::LeafNodeType::DIM == VoxelBlocks::edge);
    block_.reserve(blocks.count());
    for (const Voxel& first : blocks.first()) {
        auto* leaf = grid_->tree.touchLeaf({first.x, first.y, first.z});
        leaf->setValuesOn();
        block_.push_back(leaf->buffer().data());
    }
}

VoxelField::VoxelField(const VoxelField& other) { *this = other; }

VoxelField& VoxelField::operator=(const VoxelField& other) {
    if (this == &other) return *this;
    grid_.reset();
    block_.clear();
    if (other.grid_ == nullptr) return *this;
    grid_ = std::make_unique<Grid>(*other.grid_);
    // leaf nodes in the order of the coordinates of their first voxels, as VoxelBlocks has them
    std::vector<openvdb::DoubleTree::LeafNodeType*> leaves;
    for (auto leaf = grid_->tree.beginLeaf(); leaf; ++leaf) leaves.push_back(leaf.getLeaf());
    std::ranges::sort(leaves, {}, [](const auto* leaf) { return leaf->origin(); });
    for (auto* leaf : leaves) block_.push_back(leaf->buffer().data());
    return *this;
}

double VoxelField::sum() const {
    double sum = 0;
    for (const double* values : block_)
        for (int k = 0; k < VoxelBlocks::voxels_each; ++k) sum += values[k];
    return sum;
}

VoxelField on_blocks(const VoxelField& field, const VoxelBlocks& from, const VoxelBlocks& to) {
    VoxelField moved(to);
    for (std::size_t b = 0; b < to.count(); ++b)
        if (const std::uint32_t number = from.number(to.first()[b]); number != VoxelBlocks::none)
            std::copy_n(field.block(number / VoxelBlocks::voxels_each), VoxelBlocks::voxels_each,
                        moved.block(b));
    return moved;
}

} // namespace bris
