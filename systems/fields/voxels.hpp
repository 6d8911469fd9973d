#pragma once

#include "engine/math.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

/// A voxel by its indices along x, y and z.
struct Voxel {
    int x = 0, y = 0, z = 0;
    friend auto operator<=>(const Voxel&, const Voxel&) = default;
};

/// Cubic voxels: voxel (i, j, k) is centred at origin + size (i, j, k).
struct Lattice {
    Vec3 origin = Vec3::Zero(); ///< m
    double size = 0;            ///< m, > 0, edge of a voxel

    Vec3 centre(const Voxel& v) const { return origin + size * Vec3(v.x, v.y, v.z); }
    Voxel voxel_of(const Vec3& x) const {
        const Vec3 at = (x - origin) / size;
        return {static_cast<int>(std::floor(at.x() + 0.5)),
                static_cast<int>(std::floor(at.y() + 0.5)),
                static_cast<int>(std::floor(at.z() + 0.5))};
    }
    double volume() const { return size * size * size; } ///< m3, of a voxel
    friend bool operator==(const Lattice&, const Lattice&) = default;
};

/// A box with its edges along the axes, m.
struct Box3 {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    friend bool operator==(const Box3&, const Box3&) = default;
};

/// The blocks of 8 x 8 x 8 voxels in which fields of a scene have values, in the order of their
/// coordinates: blocks above each other are consecutive. The fields of a scene share one set of
/// blocks, so that one number names a voxel in all of them: 512 times the block plus the voxel
/// within it, of which z counts fastest.
class VoxelBlocks {
public:
    static constexpr int edge = 8, voxels_each = edge * edge * edge;

    VoxelBlocks() = default;
    /// All blocks that overlap one of the boxes.
    VoxelBlocks(const Lattice& lattice, std::span<const Box3> boxes);
    /// The given blocks, by the coordinates of their first voxels, in any order and repeated.
    VoxelBlocks(const Lattice& lattice, std::vector<Voxel> first_voxels);

    const Lattice& lattice() const { return lattice_; }
    std::size_t count() const { return first_.size(); }
    std::size_t voxels() const { return first_.size() * voxels_each; }
    /// First voxel of each block.
    const std::vector<Voxel>& first() const { return first_; }

    /// First block of each column of blocks above each other, and the number of blocks.
    std::vector<std::uint32_t> columns() const;

    static constexpr std::uint32_t none = ~std::uint32_t{0};
    /// Number of a voxel; `none` if it lies in no block.
    std::uint32_t number(const Voxel& v) const {
        const std::uint32_t block = block_at(v.x >> 3, v.y >> 3, v.z >> 3);
        return block == none ? none : block * voxels_each + within(v);
    }
    Voxel voxel(std::uint32_t number) const {
        const Voxel& f = first_[number / voxels_each];
        const int k = static_cast<int>(number % voxels_each);
        return {f.x + (k >> 6), f.y + ((k >> 3) & 7), f.z + (k & 7)};
    }
    static std::uint32_t within(const Voxel& v) {
        return static_cast<std::uint32_t>((v.x & 7) << 6 | (v.y & 7) << 3 | (v.z & 7));
    }
    /// Number of the neighbour in direction `side`: 0 and 1 are -x and +x, then y, then z. `none`
    /// if it lies in no block.
    std::uint32_t neighbour(std::uint32_t number, int side) const {
        constexpr std::array stride{64u, 8u, 1u};
        const unsigned axis = static_cast<unsigned>(side) / 2, shift = 6 - 3 * axis;
        const std::uint32_t k = number % voxels_each, at = (k >> shift) & 7;
        const bool up = side % 2 == 1;
        if (up ? at < 7 : at > 0) return up ? number + stride[axis] : number - stride[axis];
        const std::uint32_t block = beside_[number / voxels_each][static_cast<std::size_t>(side)];
        if (block == none) return none;
        return block * voxels_each + (up ? k - 7 * stride[axis] : k + 7 * stride[axis]);
    }

    friend bool operator==(const VoxelBlocks& a, const VoxelBlocks& b) {
        return a.lattice_ == b.lattice_ && a.first_ == b.first_;
    }

private:
    std::uint32_t block_at(int x, int y, int z) const {
        const int i = x - low_.x, j = y - low_.y, k = z - low_.z;
        if (i < 0 || j < 0 || k < 0 || i >= size_.x || j >= size_.y || k >= size_.z) return none;
        return block_[(static_cast<std::size_t>(i) * static_cast<std::size_t>(size_.y) +
                       static_cast<std::size_t>(j)) *
                          static_cast<std::size_t>(size_.z) +
                      static_cast<std::size_t>(k)];
    }
    void index_blocks();

    Lattice lattice_;
    std::vector<Voxel> first_;
    std::vector<std::array<std::uint32_t, 6>> beside_;
    Voxel low_, size_; // in blocks
    std::vector<std::uint32_t> block_;
};

} // namespace bris
