#include "tests/scenarios/sensors/example_recordings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace bris;
using namespace bris::testing;

namespace {

/// Changes the displacements of one sensor at a time. Returns how many of these sensors are refused
/// with the text `why`, and checks that no other sensor is refused.
std::size_t refused_by(const std::vector<Recording>& all, auto&& change, const std::string& why) {
    std::size_t count = 0;
    for (std::size_t s = 0; s < all.size(); ++s) {
        auto one = all;
        for (Vec3& u : one[s].displacement) u = change(u);
        for (const Recording& r : one) {
            const std::string found = refusals(one, r.info.id);
            if (r.info.id == s + 1)
                count += static_cast<std::size_t>(has(found, why));
            else
                CHECK(found.empty());
        }
    }
    return count;
}

const auto reversed = [](const Vec3& u) -> Vec3 { return -u; };
const auto swapped = [](const Vec3& u) { return Vec3(u.x(), u.z(), u.y()); };

} // namespace

TEST_SUITE("sensors/compare_displacements") {
    TEST_CASE("a reversed sign is detected in a rock that moves up while all others move down") {
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"}) {
            CHECK(refused_by(example_recordings(pressure), reversed,
                             "its sign seems to be reversed") >= 7);
            CHECK(refused_by(example_recordings(pressure, 0.009), reversed,
                             "its sign seems to be reversed") >= 4); // the upper ones
        }
    }

    TEST_CASE("a rock whose last samples have no strain is judged by the samples with strain") {
        for (const std::size_t without : {1u, 5u}) {
            auto all = example_recordings("110kPa");
            Recording& reversed_one = all[8];
            for (Vec3& u : reversed_one.displacement) u = -u;
            std::fill(reversed_one.strain.end() - static_cast<std::ptrdiff_t>(without),
                      reversed_one.strain.end(), std::nan(""));
            for (const Recording& r : all)
                CHECK(has(refusals(all, r.info.id), "its sign seems to be reversed") ==
                      (r.info.id == 9));
        }
    }

    TEST_CASE("swapped axes are detected in a rock that moves sideways as far as it should move "
              "down") {
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"})
            CHECK(refused_by(example_recordings(pressure), swapped,
                             "inconsistent with the other rocks") >= 6);
    }

    TEST_CASE("a rock that does not move is refused, although its displacement has noise") {
        auto all = example_recordings("110kPa");
        for (std::size_t k = 5; k < all[8].size(); ++k)
            all[8].displacement[k] =
                all[8].displacement[k % 5] * (1 + 1e-3 * static_cast<double>(k));
        CHECK(has(refusals(all, 9), "inconsistent with the other rocks"));
    }

    TEST_CASE("if all rocks move up or sideways, all are refused because of a wrong frame") {
        for (const auto& [change, why] : {std::pair<Vec3 (*)(const Vec3&), const char*>{
                                              [](const Vec3& u) -> Vec3 { return -u; },
                                              "frame: at 8.000 % of axial strain expected a "
                                              "median displacement of all sensor rocks of about"},
                                          {[](const Vec3& u) { return Vec3(u.x(), u.z(), u.y()); },
                                           "y and z of all seem to be swapped"},
                                          {[](const Vec3& u) { return Vec3(u.z(), u.y(), u.x()); },
                                           "x and z of all seem to be swapped"}}) {
            auto all = example_recordings("165kPa");
            for (Recording& r : all)
                for (Vec3& u : r.displacement) u = change(u);
            for (const Recording& r : all) CHECK(has(refusals(all, r.info.id), why));
        }
    }

    TEST_CASE("no rock is judged by the others before displacements are many times larger than "
              "their scatter") {
        CHECK(refused_by(example_recordings("55kPa", 0.003), reversed, "displacement") == 0);
    }

    TEST_CASE(
        "chance agreement of the other rocks does not refuse a rock near the bottom that lags "
        "behind") {
        auto all = example_recordings("55kPa", 0.04);
        for (Recording& r : all)
            for (std::size_t k = 5; k < r.size(); ++k)
                r.displacement[k] = 0.01 * r.displacement[k] -
                                    Vec3(0, 0, r.strain[k] * r.info.z * (r.info.id == 2 ? 0.2 : 1));
        for (const Recording& r : all) CHECK(refusals(all, r.info.id).empty());
    }

    TEST_CASE("three wrong sensors out of ten do not cause refusals of the others") {
        auto all = example_recordings("55kPa");
        for (const std::size_t s : {3u, 7u, 9u})
            for (Vec3& u : all[s].displacement) u = -u;
        for (const Recording& r : all)
            if (r.info.id != 4 && r.info.id != 8 && r.info.id != 10)
                CHECK(refusals(all, r.info.id).empty());
        CHECK(has(refusals(all, 8), "reversed"));
        CHECK(has(refusals(all, 10), "reversed"));
    }
}
