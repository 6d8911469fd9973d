#include "engine/math.hpp"
#include "engine/rows.hpp"
#include "engine/table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

struct Name : State<std::uint32_t> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct Heat : State<double> {
    static constexpr auto name = "heat", unit = "K";
};
struct Place : Derived<Vec3> {
    static constexpr auto name = "place", unit = "m";
};
struct Pace : Derived<double> {
    static constexpr auto name = "pace", unit = "m";
    static constexpr bool is_carried = true;
};
struct Record : Derived<std::array<double, 8>> {
    static constexpr auto name = "record", unit = "";
    static constexpr bool is_scratch = true;
};

#ifndef BRIS_SANITIZED
/// Bytes of memory that this process uses now.
double used_memory() {
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}
#endif

} // namespace

TEST_SUITE("engine/table") {
    TEST_CASE("new rows are zero, also if the table was larger before") {
        const auto few = std::array{10u, 4u, 1000u}, many = std::array{400'000u, 4u, 500'000u},
                   grown = std::array{400'000u, 4u, 2'000'000u};
        for (const auto& [before, kept, after] : {few, many, grown}) {
            Table table("things");
            table.add<Heat>();
            table.resize(before);
            std::fill(table.column<Heat>().begin(), table.column<Heat>().end(), 3.0);
            table.resize(kept);
            table.resize(after);
            const auto heat = table.column<Heat>();
            REQUIRE(heat.size() == after);
            CHECK(std::count(heat.begin(), heat.begin() + kept, 3.0) == kept);
            CHECK(std::count(heat.begin() + kept, heat.end(), 0.0) == after - kept);
        }
    }

    TEST_CASE("rows that are new after a permutation are zero") {
        const Row n = 300'000;
        Table table("things");
        table.add<Heat>();
        table.resize(n);
        std::fill(table.column<Heat>().begin(), table.column<Heat>().end(), 3.0);
        std::vector<Row> reversed(n);
        for (Row r = 0; r < n; ++r) reversed[r] = n - 1 - r;
        table.keep(reversed);
        table.resize(10);
        table.resize(n + 1000);
        const auto heat = table.column<Heat>();
        CHECK(std::count(heat.begin(), heat.end(), 3.0) == 10);
        CHECK(std::count(heat.begin(), heat.end(), 0.0) == n + 990);
    }

    TEST_CASE("some rows of a table are kept in the order asked for, and the others are gone") {
        for (const std::vector<Row>& kept :
             {std::vector<Row>{7, 999, 3}, {3, 7, 999}, {0, 1, 999}, {3, 3, 7}}) {
            CAPTURE(kept[1]);
            Table table("things");
            table.add<Name>();
            table.add<Place>();
            table.resize(1000);
            for (Row r = 0; r < 1000; ++r) {
                table.column<Name>()[r] = r;
                table.column<Place>()[r] = Vec3(r, 0, 1);
            }
            table.keep(kept);
            REQUIRE(table.size() == 3);
            table.resize(5);
            for (Row r = 0; r < 3; ++r) {
                CHECK(table.column<Name>()[r] == kept[r]);
                CHECK(table.column<Place>()[r] == Vec3(kept[r], 0, 1));
            }
            CHECK(table.column<Name>()[3] == 0);
            CHECK(table.column<Place>()[4] == Vec3(0, 0, 0));
            table.keep({});
            CHECK(table.column<Name>().empty());
        }
    }

    TEST_CASE("a copy of some rows has State and what is carried, and zeros for what is derived") {
        Table table("things");
        table.add<Name>();
        table.add<Place>();
        table.add<Pace>();
        table.resize(20);
        for (Row r = 0; r < 20; ++r) {
            table.column<Name>()[r] = r;
            table.column<Place>()[r] = Vec3(r, 0, 1);
            table.column<Pace>()[r] = 0.5 * r;
        }
        const Table some(table, std::vector<Row>{4, 19});
        REQUIRE(some.size() == 2);
        CHECK(some.column<Name>()[1] == 19);
        CHECK(some.column<Pace>()[1] == 9.5);
        CHECK(some.column<Place>()[1] == Vec3(0, 0, 0));
    }

#ifndef BRIS_SANITIZED // there, scratch is filled with what is not a number
    TEST_CASE("a large scratch column that nobody writes takes no memory") {
        const double before = used_memory();
        Table table("things");
        table.add<Name>();
        table.add<Record>();
        const Row n = 1'000'000; // 64 MB of records, 4 MB of names
        std::vector<Row> same(n);
        for (Row r = 0; r < n; ++r) same[r] = r;
        table.resize(n);
        table.keep(same);
        table.resize(0);
        table.resize(n);
        CHECK(used_memory() - before < 32e6);
        std::ranges::fill(table.column<Record>(), std::array<double, 8>{1});
        CHECK(used_memory() - before > 64e6);
    }
#endif

    TEST_CASE("a column that is added later is zero in every row, and adding it again changes "
              "nothing") {
        Table table("things");
        table.add<Name>();
        table.resize(5);
        const auto heat = table.add<Heat>();
        CHECK(heat.size() == 5);
        heat[3] = 7;
        CHECK(table.add<Heat>()[3] == 7);
        CHECK(table.columns().size() == 2);
    }

    TEST_CASE("a permutation moves whole rows, and its inverse moves them back") {
        Table table("things");
        table.add<Name>();
        table.add<Heat>();
        table.add<Place>();
        const Row n = 300;
        table.resize(n);
        std::vector<Row> new_to_old(n), inverse(n);
        for (Row r = 0; r < n; ++r) {
            table.column<Name>()[r] = r;
            table.column<Heat>()[r] = 0.5 * r;
            table.column<Place>()[r] = Vec3(r, 2 * r, 3 * r);
            new_to_old[r] = (7 * r + 11) % n; // a permutation, since 7 and 300 are coprime
        }
        for (Row r = 0; r < n; ++r) inverse[new_to_old[r]] = r;
        table.keep(new_to_old);
        for (Row r = 0; r < n; ++r) {
            const Row old = new_to_old[r];
            REQUIRE(table.column<Name>()[r] == old);
            REQUIRE(table.column<Heat>()[r] == 0.5 * old);
            REQUIRE(table.column<Place>()[r] == Vec3(old, 2 * old, 3 * old));
        }
        table.keep(inverse);
        for (Row r = 0; r < n; ++r) REQUIRE(table.column<Name>()[r] == r);
    }

    TEST_CASE("columns begin on a cache line, however large they grow") {
        Table table("things");
        table.add<Heat>();
        for (const std::size_t n : {1u, 100u, 10'000u, 1'000'000u}) {
            table.resize(n);
            CHECK(reinterpret_cast<std::uintptr_t>(table.column<Heat>().data()) % 64 == 0);
        }
    }

    TEST_CASE("a copy of a table is independent of the original") {
        Table table("things");
        table.add<Heat>();
        table.resize(3);
        table.column<Heat>()[1] = 5;
        Table copy(table);
        copy.column<Heat>()[1] = 6;
        copy.resize(9);
        CHECK(table.column<Heat>()[1] == 5);
        CHECK(table.size() == 3);
        CHECK(copy.size() == 9);
    }

    TEST_CASE("access to a missing column throws a logic error with the name of the table") {
        Table table("things");
        CHECK_THROWS_WITH_AS(table.column<Heat>(), doctest::Contains("things"), std::logic_error);
    }
}
