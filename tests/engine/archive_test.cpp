#include "engine/archive.hpp"
#include "engine/errors.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace bris;

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
