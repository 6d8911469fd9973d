#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/state.hpp"
#include "tests/engine/things.hpp"

#include <doctest/doctest.h>

#include <numeric>

using namespace bris;

namespace {

struct Glow : Derived<double> {
    static constexpr auto name = "glow", unit = "W";
};

struct Links {
    static constexpr auto name = "links";
};
struct TwoNames {
    std::uint32_t a, b;
};
struct Ends : State<TwoNames, std::uint32_t> {
    static constexpr auto name = "ends", unit = "";
    static constexpr bool is_key = true;
};
struct Stretch : State<double> {
    static constexpr auto name = "stretch", unit = "m";
    static bool keep(const double& s) { return s != 0; }
};

World world_of(std::uint32_t n) {
    World world;
    Table& things = world.table<Things>();
    things.add<Name>();
    things.add<Heat>();
    things.add<Glow>();
    things.resize(n);
    for (std::uint32_t r = 0; r < n; ++r) {
        things.column<Name>()[r] = r;
        things.column<Heat>()[r] = 0.1 * r;
        things.column<Glow>()[r] = r;
    }
    return world;
}

} // namespace

TEST_SUITE("engine/state") {
    TEST_CASE(
        "the saved state is in the order of the key and does not depend on the order of the rows") {
        World world = world_of(20);
        const Archive before = save_state(world);
        std::vector<Row> order(20);
        for (Row r = 0; r < 20; ++r) order[r] = (3 * r + 5) % 20;
        world.table<Things>().keep(order);
        const Archive after = save_state(world);
        CHECK(fingerprint(before) == fingerprint(after));
        CHECK(after.get<std::uint32_t>("things/id").front() == 0);
        CHECK(after.find("things/glow") == nullptr); // Derived is not saved
        world.column<Things, Glow>()[3] = 99;
        CHECK(fingerprint(save_state(world)) == fingerprint(before));
        world.column<Things, Heat>()[3] = 99;
        CHECK(fingerprint(save_state(world)) != fingerprint(before));
    }

    TEST_CASE("loading restores what was saved, with the rows in key order") {
        World world = world_of(20), other = world_of(3);
        std::vector<Row> order(20);
        for (Row r = 0; r < 20; ++r) order[r] = 19 - r;
        world.table<Things>().keep(order);
        const Archive saved = save_state(world);
        load_state(other, saved);
        REQUIRE(other.table<Things>().size() == 20);
        for (Row r = 0; r < 20; ++r) {
            CHECK(other.column<Things, Name>()[r] == r);
            CHECK(other.column<Things, Heat>()[r] == 0.1 * r);
            CHECK(other.column<Things, Glow>()[r] == 0);
        }
        CHECK(fingerprint(save_state(other)) == fingerprint(saved));
    }

    TEST_CASE("keys of several numbers are sorted lexicographically, and rows without content are "
              "left out") {
        World world;
        Table& links = world.table<Links>();
        links.add<Ends>();
        links.add<Stretch>();
        const std::vector<TwoNames> ends{{2, 1}, {0, 70000}, {0, 3}, {2, 0}, {1, 9}};
        const std::vector<double> stretch{5, 4, 3, 0, 1};
        links.resize(ends.size());
        for (std::size_t r = 0; r < ends.size(); ++r) {
            links.column<Ends>()[r] = ends[r];
            links.column<Stretch>()[r] = stretch[r];
        }
        const Archive saved = save_state(world);
        CHECK(saved.get<std::uint32_t>("links/ends") ==
              std::vector<std::uint32_t>{0, 3, 0, 70000, 1, 9, 2, 1});
        CHECK(saved.get<double>("links/stretch") == std::vector<double>{3, 4, 1, 5});
    }

    TEST_CASE(
        "a state of another scene is rejected with a one-line message that names what is missing") {
        World world = world_of(3);
        CHECK_THROWS_WITH_AS(load_state(world, Archive{}), doctest::Contains("things"), InputError);
        Archive wrong = save_state(world);
        const std::vector<std::uint32_t> id{0, 1};
        Archive shorter;
        shorter.put("things/id", std::span<const std::uint32_t>(id));
        CHECK_THROWS_WITH_AS(load_state(world, shorter), doctest::Contains("things/heat"),
                             InputError);
    }
}
