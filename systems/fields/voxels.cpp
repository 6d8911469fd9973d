#include "systems/fields/voxels.hpp"

#include <algorithm>

namespace bris {

namespace {

int block_of(int voxel) { return voxel >> 3; }

} // namespace

VoxelBlocks::VoxelBlocks(const Lattice& lattice, std::span<const Box3> boxes) : lattice_(lattice) {
    if (boxes.empty()) return;
    const auto low_of = [&](const Box3& b) { return lattice.voxel_of(b.low); };
    const auto high_of = [&](const Box3& b) { return lattice.voxel_of(b.high); };
    Voxel low = low_of(boxes[0]), high = high_of(boxes[0]);
    for (const Box3& b : boxes) {
        const Voxel l = low_of(b), h = high_of(b);
        low = {std::min(low.x, l.x), std::min(low.y, l.y), std::min(low.z, l.z)};
        high = {std::max(high.x, h.x), std::max(high.y, h.y), std::max(high.z, h.z)};
    }
    const int bx = block_of(low.x), by = block_of(low.y), bz = block_of(low.z);
    const int nx = block_of(high.x) - bx + 1, ny = block_of(high.y) - by + 1,
              nz = block_of(high.z) - bz + 1;
    const auto at = [&](int i, int j, int k) {
        return (static_cast<std::size_t>(i - bx) * static_cast<std::size_t>(ny) +
                static_cast<std::size_t>(j - by)) *
                   static_cast<std::size_t>(nz) +
               static_cast<std::size_t>(k - bz);
    };
    std::vector<char> touched(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                              static_cast<std::size_t>(nz));
    for (const Box3& b : boxes) {
        const Voxel l = low_of(b), h = high_of(b);
        for (int i = block_of(l.x); i <= block_of(h.x); ++i)
            for (int j = block_of(l.y); j <= block_of(h.y); ++j)
                for (int k = block_of(l.z); k <= block_of(h.z); ++k) touched[at(i, j, k)] = 1;
    }
    for (int i = bx; i < bx + nx; ++i)
        for (int j = by; j < by + ny; ++j)
            for (int k = bz; k < bz + nz; ++k)
                if (touched[at(i, j, k)] != 0) first_.push_back({i * edge, j * edge, k * edge});
    index_blocks();
}

VoxelBlocks::VoxelBlocks(const Lattice& lattice, std::vector<Voxel> first_voxels)
    : lattice_(lattice), first_(std::move(first_voxels)) {
    std::ranges::sort(first_);
    first_.erase(std::unique(first_.begin(), first_.end()), first_.end());
    index_blocks();
}

std::vector<std::uint32_t> VoxelBlocks::columns() const {
    std::vector<std::uint32_t> first;
    for (std::uint32_t b = 0; b < first_.size(); ++b)
        if (b == 0 || first_[b].x != first_[b - 1].x || first_[b].y != first_[b - 1].y)
            first.push_back(b);
    first.push_back(static_cast<std::uint32_t>(first_.size()));
    return first;
}

void VoxelBlocks::index_blocks() {
    block_.clear();
    beside_.clear();
    if (first_.empty()) return;
    Voxel high = first_[0];
    low_ = first_[0];
    for (const Voxel& f : first_) {
        low_ = {std::min(low_.x, f.x), std::min(low_.y, f.y), std::min(low_.z, f.z)};
        high = {std::max(high.x, f.x), std::max(high.y, f.y), std::max(high.z, f.z)};
    }
    size_ = {(high.x - low_.x) / edge + 1, (high.y - low_.y) / edge + 1,
             (high.z - low_.z) / edge + 1};
    low_ = {block_of(low_.x), block_of(low_.y), block_of(low_.z)};
    block_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                      static_cast<std::size_t>(size_.z),
                  none);
    for (std::size_t b = 0; b < first_.size(); ++b) {
        const int i = block_of(first_[b].x) - low_.x, j = block_of(first_[b].y) - low_.y,
                  k = block_of(first_[b].z) - low_.z;
        block_[(static_cast<std::size_t>(i) * static_cast<std::size_t>(size_.y) +
                static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size_.z) +
               static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(b);
    }
    for (const Voxel& f : first_) {
        const int x = block_of(f.x), y = block_of(f.y), z = block_of(f.z);
        beside_.push_back({block_at(x - 1, y, z), block_at(x + 1, y, z), block_at(x, y - 1, z),
                           block_at(x, y + 1, z), block_at(x, y, z - 1), block_at(x, y, z + 1)});
    }
}

} // namespace bris
