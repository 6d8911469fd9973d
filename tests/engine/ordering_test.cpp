#include "engine/ordering.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

using namespace bris;

TEST_SUITE("engine/ordering") {
    TEST_CASE("a Morton code interleaves the bits of its three numbers") {
        Random random(2, 0);
        for (int k = 0; k < 200; ++k) {
            const std::array<std::uint32_t, 3> c{
                static_cast<std::uint32_t>(random.bits() & 0x1fffff),
                static_cast<std::uint32_t>(random.bits() & 0x1fffff),
                static_cast<std::uint32_t>(random.bits() & 0x1fffff)};
            std::uint64_t expected = 0;
            for (unsigned bit = 0; bit < 21; ++bit)
                for (unsigned a = 0; a < 3; ++a)
                    expected |= static_cast<std::uint64_t>((c[a] >> bit) & 1) << (3 * bit + a);
            CHECK(morton_code(c[0], c[1], c[2]) == expected);
        }
    }

    TEST_CASE(
        "the Morton order contains every row once and does not depend on the order of its input") {
        Random random(5, 0);
        const std::size_t n = 500;
        std::vector<Vec3> x(n);
        std::vector<EntityId> id(n);
        std::iota(id.begin(), id.end(), 0u);
        // many positions share a cell, some are equal
        for (auto& v : x)
            v = Vec3(std::floor(4 * random.uniform()), 4 * random.uniform(),
                     std::floor(3 * random.uniform()));
        const auto ids_in_order = [&](std::span<const Row> shuffle) {
            std::vector<Vec3> moved(n);
            std::vector<EntityId> moved_id(n);
            for (std::size_t r = 0; r < n; ++r) {
                moved[r] = x[shuffle[r]];
                moved_id[r] = id[shuffle[r]];
            }
            std::vector<EntityId> names;
            for (const Row r : morton_order(moved, moved_id, 0.9)) names.push_back(moved_id[r]);
            return names;
        };
        std::vector<Row> rows(n);
        std::iota(rows.begin(), rows.end(), 0u);
        const auto reference = ids_in_order(rows);
        auto sorted = reference;
        std::sort(sorted.begin(), sorted.end());
        CHECK(sorted == id);
        for (int k = 0; k < 5; ++k) {
            for (std::size_t i = n; i > 1; --i) std::swap(rows[i - 1], rows[random.bits() % i]);
            CHECK(ids_in_order(rows) == reference);
        }
    }

    TEST_CASE("neighbours along the Morton curve are neighbours in space") {
        // along a full 8 x 8 x 8 lattice the mean step of a Morton curve is below 2 cells
        std::vector<Vec3> x;
        std::vector<EntityId> id;
        for (int k = 0; k < 512; ++k) {
            x.emplace_back(k % 8 + 0.5, k / 8 % 8 + 0.5, k / 64 + 0.5);
            id.push_back(static_cast<EntityId>(k));
        }
        const auto order = morton_order(x, id, 1.0);
        double path = 0;
        for (std::size_t r = 1; r < order.size(); ++r)
            path += (x[order[r]] - x[order[r - 1]]).norm();
        CHECK(path / 511 < 2);
    }

    TEST_CASE("the row of an id is found among ids without gaps, with gaps, and at the limits") {
        Random random(5, 0);
        for (const EntityId apart : {1u, 3u, 1000u, 4'000'000u}) {
            CAPTURE(apart);
            std::vector<EntityId> ids;
            for (EntityId k = 0; k < 1000; ++k) ids.push_back(7 + k * apart);
            if (apart > 1000) ids.push_back(nobody);
            for (std::size_t i = ids.size(); i > 1; --i)
                std::swap(ids[i - 1], ids[random.bits() % i]);
            const RowIndex row_of(ids);
            for (Row r = 0; r < ids.size(); ++r) REQUIRE(row_of[ids[r]] == r);
            for (const EntityId absent : {0u, 6u, 8u + 1000 * apart})
                CHECK(row_of[absent] == no_row);
            CHECK((row_of[8] == no_row) == (apart > 1));
        }
        CHECK(RowIndex({})[3] == no_row);
    }

    TEST_CASE("no positions give an empty order") { CHECK(morton_order({}, {}, 1).empty()); }
}
