#include "systems/fields/bed_surface.hpp"

#include <doctest/doctest.h>

#include <array>
#include <functional>

using namespace bris;

namespace {

/// A box of 32 x 16 x 32 voxels, in which rocks fill each column up to a height.
struct Bed {
    VoxelBlocks blocks;
    VoxelField solid, shown;

    explicit Bed(const std::function<int(int, int)>& height)
        : blocks(Lattice{Vec3::Zero(), 1},
                 std::array{Box3{Vec3(0.1, 0.1, 0.1), Vec3(30.9, 14.9, 30.9)}}),
          solid(blocks), shown(blocks) {
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
            const Voxel v = blocks.voxel(n);
            solid[n] = v.z <= height(v.x, v.y) ? 0.6 : 0;
            shown[n] = 1;
        }
    }
    /// Highest voxel shown; -1: none.
    int top(int x, int y) const {
        for (int z = 31; z >= 0; --z)
            if (shown[blocks.number({x, y, z})] != 0) return z;
        return -1;
    }
};

} // namespace

TEST_SUITE("fields/bed_surface") {
    TEST_CASE("air over a slope is hidden, and every void below its surface is shown") {
        Bed bed([](int x, int) { return 28 - x / 2; });
        bed.solid[bed.blocks.number({9, 7, 3})] = 0; // a void
        hide_air_above(bed.shown, bed.solid, bed.blocks, 3);
        for (int x = 0; x < 32; ++x)
            for (int y = 0; y < 16; ++y) {
                CAPTURE(x);
                CHECK(bed.top(x, y) >= 28 - x / 2);
                CHECK(bed.top(x, y) <= 28 - x / 2 + (x > 28 ? 1 : 0)); // half a window at the edge
            }
        CHECK(bed.shown[bed.blocks.number({9, 7, 3})] == 1);
    }

    TEST_CASE("a dip between rocks belongs to the bed, a ditch does not") {
        Bed bed([](int x, int) { return x >= 4 && x < 8 ? 5 : x >= 14 && x < 24 ? 8 : 20; });
        hide_air_above(bed.shown, bed.solid, bed.blocks, 3);
        CHECK(bed.top(5, 5) == 20);
        CHECK(bed.top(18, 5) == 8);
        CHECK(bed.top(28, 5) == 20);
    }

    TEST_CASE("columns beside the container do not lower the bed at its edge") {
        // rocks end two voxels before the wall at x = 20, behind which there is nothing
        Bed bed([](int x, int) { return x < 18 ? 20 : -1; });
        for (std::uint32_t n = 0; n < bed.blocks.voxels(); ++n)
            if (bed.blocks.voxel(n).x >= 20) bed.shown[n] = 0;
        hide_air_above(bed.shown, bed.solid, bed.blocks, 3);
        CHECK(bed.top(19, 5) == 20);
        CHECK(bed.top(20, 5) == -1);
    }
}
