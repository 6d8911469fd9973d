#include "engine/archive.hpp"
#include "engine/errors.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

using namespace bris;

namespace {

template <class T>
Archive::Array array_of(const std::string& path, const std::vector<T>& values, std::size_t columns,
                        const std::string& key) {
    Archive::Array array{
        path, std::is_integral_v<T> ? Scalar::integer : Scalar::real, sizeof(T), columns, {}, key};
    array.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
    return array;
}

/// A table of pairs of ids, each with a number.
Archive table_of(const std::vector<std::uint32_t>& pairs, const std::vector<double>& numbers) {
    Archive archive;
    archive.put(array_of("springs/pair", pairs, 2, "springs/pair"));
    archive.put(array_of("springs/force", numbers, 1, "springs/pair"));
    return archive;
}

} // namespace

TEST_SUITE("engine/archive") {
    TEST_CASE("an archive returns the numbers that were stored, also for empty arrays") {
        Archive archive;
        const std::vector<double> real{1.5, -0.0, 1e-310};
        const std::vector<std::uint64_t> whole{};
        archive.put("a/real", std::span<const double>(real));
        archive.put("a/whole", std::span<const std::uint64_t>(whole));
        CHECK(archive.get<double>("a/real") == real);
        CHECK(archive.get<std::uint64_t>("a/whole").empty());
        CHECK(archive.find("a/real")->rows() == 3);
        CHECK(archive.find("a/nothing") == nullptr);
    }

    TEST_CASE("a missing array or numbers of another size are reported with the array's name") {
        Archive archive;
        const std::vector<float> few{1};
        archive.put("x", std::span<const float>(few));
        CHECK_THROWS_WITH_AS(archive.get<double>("y"), doctest::Contains("'y'"), InputError);
        CHECK_THROWS_WITH_AS(archive.get<double>("x"), doctest::Contains("'x'"), InputError);
    }

    TEST_CASE("the fingerprint changes with any single bit and with the order of the numbers, but "
              "not with the names") {
        const auto print = [](const std::string& path, std::vector<double> numbers) {
            Archive archive;
            archive.put(path, std::span<const double>(numbers));
            return fingerprint(archive);
        };
        const auto reference = print("a", {1, 2, 3});
        CHECK(print("a", {1, 2, 3}) == reference);
        CHECK(print("a", {1, 2, std::nextafter(3.0, 4.0)}) != reference);
        CHECK(print("a", {2, 1, 3}) != reference);
        CHECK(print("b", {1, 2, 3}) == reference);
        CHECK(print("a", {1, 2, 3, 0}) != reference);
        CHECK(print("a", {1, 2, -3}) != reference);
        CHECK(print("a", {0}) != print("a", {-0.0}));
    }

    TEST_CASE("the fingerprint does not depend on what only the guard reads") {
        const std::vector<double> numbers{1, 2};
        Archive plain, guarded;
        guarded.put("guard/box", std::span<const double>(numbers));
        for (Archive* archive : {&plain, &guarded})
            archive->put("bodies/x", std::span<const double>(numbers));
        CHECK(fingerprint(plain) == fingerprint(guarded));
    }

    TEST_CASE(
        "the rows of each 65 536 ids are hashed by themselves, so that whoever holds them can "
        "do it") {
        const Archive whole = table_of({3, 70000, 65535, 65536, 65536, 1, 400000, 2}, {1, 2, 3, 4});
        const auto blocks = hash_blocks(whole);
        REQUIRE(blocks.size() == 3);
        CHECK(blocks[0].ids == 0);
        CHECK(blocks[1].ids == 1);
        CHECK(blocks[2].ids == 6);
        CHECK(hash_blocks(table_of({3, 70000, 65535, 65536}, {1, 2})) ==
              std::vector{blocks[0]}); // another rank's part
        CHECK(hash_blocks(table_of({65536, 1, 400000, 2}, {3, 4})) ==
              std::vector{blocks[1], blocks[2]});
        const auto other = hash_blocks(table_of({3, 70000, 65535, 65536, 65536, 1, 400000, 2},
                                                {1, 2, std::nextafter(3., 4.), 4}));
        CHECK(other[0] == blocks[0]);
        CHECK(other[1].hash != blocks[1].hash);
        CHECK(other[2] == blocks[2]);
        CHECK(fingerprint(whole, other) != fingerprint(whole));
        CHECK(fingerprint(whole, blocks) == fingerprint(whole));
        // moved to other ids of the same order
        CHECK(fingerprint(table_of({3, 70000, 65535, 65536, 65537, 1, 400000, 2}, {1, 2, 3, 4})) !=
              fingerprint(whole));
        CHECK(fingerprint(whole, "springs/force") !=
              fingerprint(table_of({3, 70000, 65535, 65536, 131072, 1, 400000, 2}, {1, 2, 3, 4}),
                          "springs/force"));
    }

    TEST_CASE("a table without rows and tables of different length have a hash or a message") {
        CHECK(hash_blocks(table_of({}, {})).size() == 1);
        CHECK(fingerprint(table_of({}, {})) != fingerprint(Archive{}));
        CHECK_THROWS_WITH_AS(hash_blocks(table_of({1, 2, 3, 4}, {1})),
                             doctest::Contains("'springs/force': expected 2 rows, found 1"),
                             InputError);
        Archive keyless;
        keyless.put(array_of("a/x", std::vector<double>{1}, 1, "a/id"));
        CHECK_THROWS_WITH_AS(hash_blocks(keyless), doctest::Contains("expected the ids 'a/id'"),
                             InputError);
    }

    TEST_CASE("the fingerprint of a part depends on that part only") {
        const std::vector<double> one{1}, two{2};
        Archive a, b;
        a.put("bodies/x", std::span<const double>(one));
        a.put("clock", std::span<const double>(one));
        b.put("bodies/x", std::span<const double>(one));
        b.put("clock", std::span<const double>(two));
        CHECK(fingerprint(a) != fingerprint(b));
        CHECK(fingerprint(a, "bodies/") == fingerprint(b, "bodies/"));
    }
}
