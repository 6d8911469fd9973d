#include "engine/lanes.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

constexpr auto width = static_cast<std::size_t>(lane_count);
using Numbers = std::array<std::array<double, 4>, width>; // one row per lane

Numbers random_rows(std::uint64_t seed) {
    Random random(seed, 0);
    Numbers rows;
    for (auto& row : rows)
        for (double& x : row) x = random.uniform(-1, 1);
    return rows;
}

FourLanes loaded(const Numbers& rows) {
    return load_rows([&](int q) { return rows[static_cast<std::size_t>(q)].data(); });
}

} // namespace

TEST_SUITE("engine/lanes") {
    TEST_CASE("after a transpose, lane q of column c holds number c of row q") {
        const Numbers rows = random_rows(1);
        const FourLanes columns = transpose(loaded(rows));
        for (std::size_t q = 0; q < width; ++q)
            for (std::size_t c = 0; c < 4; ++c) CHECK(columns[c][q] == rows[q][c]);
    }

    TEST_CASE("transposing twice and storing gives the rows back, and only as many as requested") {
        const Numbers rows = random_rows(2);
        const FourLanes twice = transpose(transpose(loaded(rows)));
        for (int count = 0; count <= lane_count; ++count) {
            Numbers stored{};
            store_rows(twice, count,
                       [&](int q) { return stored[static_cast<std::size_t>(q)].data(); });
            for (std::size_t q = 0; q < width; ++q)
                CHECK(stored[q] ==
                      (static_cast<int>(q) < count ? rows[q] : std::array<double, 4>{}));
        }
    }

    TEST_CASE("triples are split into x, y and z, and joined again") {
        Random random(7, 0);
        std::array<double, 3 * width> rows, stored{};
        for (double& number : rows) number = random.uniform(-1, 1);
        const ThreeLanes v = load_triples(rows.data());
        for (std::size_t q = 0; q < width; ++q)
            for (std::size_t c = 0; c < 3; ++c) CHECK(v[c][q] == rows[3 * q + c]);
        store_triples(stored.data(), v);
        CHECK(stored == rows);
    }

    TEST_CASE("row sums add pairs first, in the same way in every lane") {
        const Numbers rows = random_rows(3);
        const Lane sums = row_sums(loaded(rows));
        for (std::size_t q = 0; q < width; ++q)
            CHECK(sums[q] == (rows[q][0] + rows[q][1]) + (rows[q][2] + rows[q][3]));
    }

    TEST_CASE("bits() reports the lanes for which a comparison is true") {
        for (unsigned pattern = 0; pattern < (1u << width); ++pattern) {
            Lane a{};
            for (std::size_t q = 0; q < width; ++q) a[q] = ((pattern >> q) & 1) != 0 ? -1.0 : 1.0;
            CHECK(bits(a < 0.0) == pattern);
        }
    }

    TEST_CASE("square root, minimum and maximum are those of the single numbers") {
        Random random(4, 0);
        Lane a{}, b{};
        for (std::size_t q = 0; q < width; ++q) {
            a[q] = random.uniform(0, 9);
            b[q] = random.uniform(0, 9);
        }
        const Lane root = sqrt(a), least = min(a, b), greatest = max(a, b);
        for (std::size_t q = 0; q < width; ++q) {
            CHECK(root[q] == std::sqrt(a[q]));
            CHECK(least[q] == std::min(a[q], b[q]));
            CHECK(greatest[q] == std::max(a[q], b[q]));
        }
    }

    TEST_CASE("numbers are rounded to the nearest integer, halves to the even one") {
        Lane a{};
        const std::array<double, 4> number{2.5, -3.5, 0x1p52 + 1, -0.49999999999999994};
        const std::array<std::int64_t, 4> expected{2, -4, (std::int64_t{1} << 52) + 1, 0};
        for (std::size_t q = 0; q < width; ++q) a[q] = number[q % 4];
        const LaneMask n = nearest_integers(a);
        for (std::size_t q = 0; q < width; ++q) CHECK(n[q] == expected[q % 4]);
        // and so are those of any size up to 2^62
        Random draw(1, 2);
        for (int k = 0; k < 20000; ++k) {
            const double size = std::ldexp(draw.uniform(-1, 1), k % 66 - 3),
                         x = k % 5 == 0 ? std::floor(size) + 0.5 : size;
            CHECK(nearest_integers(lanes(x))[k % lane_count] == std::llrint(x));
        }
    }

    TEST_CASE("integer rows are added and subtracted, also where lanes share a row") {
        const auto numbers = [](std::int64_t offset) {
            FourLanes columns;
            for (std::size_t i = 0; i < 4; ++i) {
                LaneMask n{};
                for (std::size_t q = 0; q < width; ++q)
                    n[q] = static_cast<std::int64_t>(100 * q + i) + offset;
                columns[i] = reinterpret_cast<Lane>(n);
            }
            return transpose(columns);
        };
        for (const int count : {lane_count, lane_count - 1, 1}) {
            using Row8 = std::array<std::int64_t, 8>;
            std::array<Row8, 2> sums{{{1, 2, 3, 4, 5, 6, 7, 8}, {9, 10, 11, 12, 13, 14, 15, 16}}};
            const auto before = sums;
            auto expected = sums;
            for (int q = 0; q < count; ++q)
                for (std::size_t i = 0; i < 8; ++i)
                    expected[static_cast<std::size_t>(q % 2)][i] +=
                        100 * q + static_cast<std::int64_t>(i % 4) + (i < 4 ? -300 : 7000);
            const auto row_of = [&](int q) { return sums[static_cast<std::size_t>(q % 2)].data(); };
            add_integer_rows<false>(numbers(-300), numbers(7000), count, row_of);
            CHECK(sums == expected);
            add_integer_rows<true>(numbers(-300), numbers(7000), count, row_of);
            CHECK(sums == before);
        }
    }
}
