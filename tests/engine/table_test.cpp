#include "engine/math.hpp"
#include "engine/rows.hpp"
#include "engine/table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

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

} // namespace

TEST_SUITE("engine/table") {
    TEST_CASE("new rows are zero, also if the table was larger before") {
        Table table("things");
        table.add<Heat>();
        table.resize(10);
        std::fill(table.column<Heat>().begin(), table.column<Heat>().end(), 3.0);
        table.resize(4);
        table.resize(1000);
        const auto heat = table.column<Heat>();
        REQUIRE(heat.size() == 1000);
        CHECK(std::count(heat.begin(), heat.begin() + 4, 3.0) == 4);
        CHECK(std::count(heat.begin() + 4, heat.end(), 0.0) == 996);
    }

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
        table.permute(new_to_old);
        for (Row r = 0; r < n; ++r) {
            const Row old = new_to_old[r];
            REQUIRE(table.column<Name>()[r] == old);
            REQUIRE(table.column<Heat>()[r] == 0.5 * old);
            REQUIRE(table.column<Place>()[r] == Vec3(old, 2 * old, 3 * old));
        }
        table.permute(inverse);
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
