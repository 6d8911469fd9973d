#include "engine/random.hpp"
#include "systems/fields/displace.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

VoxelBlocks cube(int blocks) {
    const double side = 8 * blocks;
    const Box3 box{Vec3::Constant(0.1), Vec3::Constant(side - 1.1)};
    return {Lattice{Vec3::Zero(), 1}, {&box, 1}};
}

} // namespace

TEST_SUITE("fields/displace") {
    TEST_CASE("what a voxel cannot hold goes to its nearest neighbours, as they have room") {
        const VoxelBlocks blocks = cube(2);
        VoxelField amount(blocks), capacity(blocks);
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) capacity[n] = 1;
        const auto at = [&](int x, int y, int z) { return blocks.number({x, y, z}); };
        capacity[at(8, 8, 8)] = 0.25; // a rock fills three quarters
        amount[at(8, 8, 8)] = 0.75;
        amount[at(9, 8, 8)] = 0.5; // half full, so it takes half as much as the others
        CHECK(displace_excess(amount, blocks, capacity, 0x1p-40) == 0);
        CHECK(amount[at(8, 8, 8)] == 0.25);
        CHECK(amount[at(7, 8, 8)] == doctest::Approx(0.5 / 5.5));
        CHECK(amount[at(8, 8, 9)] == doctest::Approx(0.5 / 5.5));
        CHECK(amount[at(9, 8, 8)] == doctest::Approx(0.5 + 0.25 / 5.5));
        CHECK(amount.sum() == 1.25);
    }

    TEST_CASE("what fills the neighbours goes further, and what finds no place stays and is told") {
        const VoxelBlocks blocks = cube(1);
        VoxelField amount(blocks), capacity(blocks);
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) capacity[n] = 1;
        const auto at = [&](int x, int y, int z) { return blocks.number({x, y, z}); };
        amount[at(4, 4, 4)] = 30;
        CHECK(displace_excess(amount, blocks, capacity, 0x1p-40) == 0);
        CHECK(amount[at(4, 4, 4)] == 1);
        CHECK(amount[at(5, 4, 4)] == 1);   // of 6 at distance 1
        CHECK(amount[at(5, 5, 4)] == 1);   // of 12 at distance sqrt 2
        CHECK(amount[at(5, 5, 5)] == 1);   // of 8 at distance sqrt 3
        CHECK(amount[at(6, 4, 4)] == 0.5); // of 6 at distance 2
        CHECK(amount.sum() == 30);
        amount[at(0, 0, 0)] = 600; // more than all voxels together
        const double stuck = displace_excess(amount, blocks, capacity, 0x1p-40);
        CHECK(amount.sum() == 630);
        CHECK(stuck > 80);
        CHECK(amount[at(0, 0, 0)] == 1 + stuck);
    }

    TEST_CASE("amounts in exact units are conserved to the last bit over 1e5 displacements") {
        const VoxelBlocks blocks = cube(2);
        VoxelField amount(blocks), capacity(blocks);
        const double unit = exact_unit(1000);
        CHECK(1000 / unit < 0x1p53);
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
            capacity[n] = Random(5, n).uniform(0.2, 1);
            amount[n] = floor_to(unit, 0.6 * capacity[n]);
        }
        const double before = amount.sum();
        std::uint64_t moves = 0;
        for (std::uint64_t round = 0; moves < 100000; ++round) {
            Random random(6, round);
            for (unsigned k = 0; k < 500; ++k) {
                const auto n = static_cast<std::uint32_t>(random.uniform() *
                                                          static_cast<double>(blocks.voxels()));
                capacity[n] = random.uniform(0.2, 1);
                if (floor_to(unit, capacity[n]) < amount[n]) ++moves;
            }
            REQUIRE(displace_excess(amount, blocks, capacity, unit) == 0);
        }
        CHECK(amount.sum() == before);
    }
}
