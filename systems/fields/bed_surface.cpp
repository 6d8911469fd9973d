#include "systems/fields/bed_surface.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace bris {

namespace {

constexpr int unknown = std::numeric_limits<int>::min(); // no rock there

/// A height for each column of voxels in a rectangle.
class Heights {
public:
    Heights(const VoxelBlocks& blocks) {
        for (const Voxel& first : blocks.first()) {
            low_ = {std::min(low_.x, first.x), std::min(low_.y, first.y), 0};
            high_ = {std::max(high_.x, first.x), std::max(high_.y, first.y), 0};
        }
        size_ = {high_.x - low_.x + VoxelBlocks::edge, high_.y - low_.y + VoxelBlocks::edge, 0};
        of_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), unknown);
    }
    int& at(int x, int y) { return of_[index(x - low_.x, y - low_.y)]; }

    /// Replaces each height by the `best` of those within the half width along both axes.
    template <class Best>
    void filter(int half_width, Best&& best) {
        for (const bool along_x : {true, false}) {
            const std::vector<int> before = of_;
            for (int x = 0; x < size_.x; ++x)
                for (int y = 0; y < size_.y; ++y) {
                    const int here = along_x ? x : y, end = along_x ? size_.x : size_.y;
                    const int last = std::min(end - 1, here + half_width);
                    for (int k = std::max(0, here - half_width); k <= last; ++k)
                        of_[index(x, y)] =
                            best(of_[index(x, y)], before[along_x ? index(k, y) : index(x, k)]);
                }
        }
    }
    /// Columns outside of the container have no say.
    void ignore_where(const Heights& absent) {
        for (std::size_t k = 0; k < of_.size(); ++k)
            if (absent.of_[k] == unknown) of_[k] = std::numeric_limits<int>::max();
    }

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) +
               static_cast<std::size_t>(y);
    }
    Voxel low_{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), 0};
    Voxel high_{unknown, unknown, 0}, size_;
    std::vector<int> of_;
};

} // namespace

void hide_air_above(VoxelField& shown, const VoxelField& solid, const VoxelBlocks& blocks,
                    int half_width) {
    if (blocks.voxels() == 0) return;
    Heights surface(blocks), container(blocks);
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
        const Voxel v = blocks.voxel(n);
        if (solid[n] > 0) surface.at(v.x, v.y) = std::max(surface.at(v.x, v.y), v.z);
        if (shown[n] != 0) container.at(v.x, v.y) = v.z;
    }
    surface.filter(half_width, [](int a, int b) { return std::max(a, b); });
    surface.ignore_where(container);
    surface.filter(half_width, [](int a, int b) { return std::min(a, b); });
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n)
        if (const Voxel v = blocks.voxel(n); v.z > surface.at(v.x, v.y)) shown[n] = 0;
}

} // namespace bris
