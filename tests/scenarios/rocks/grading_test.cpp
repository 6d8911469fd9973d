#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "scenarios/rocks/grading.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace bris;

namespace {

/// Two rocks of sieve size 1 m; only their volumes matter here.
std::vector<Clump> two_clumps() {
    Clump ball, pair;
    ball.balls = {{Vec3(0, 0, 0), 0.5}};
    ball.volume = pi / 6;
    pair.balls = {{Vec3(-0.5, 0, 0), 0.5}, {Vec3(0.5, 0, 0), 0.5}};
    pair.volume = pi / 3;
    ball.sieve = pair.sieve = 1;
    return {ball, pair};
}

Grading grading_of(const std::string& rows) {
    const TemporaryDirectory folder;
    const auto path = folder / "grading.csv";
    std::ofstream(path) << "sieve_mm,lower_percent,upper_percent\n" << rows;
    return read_grading(path);
}

} // namespace

TEST_SUITE("rocks/grading") {
    TEST_CASE("every AREMA grading is read, and size_at inverts its mid-range curve") {
        int count = 0;
        for (const auto& entry :
             std::filesystem::directory_iterator(assets_folder() / "gradings")) {
            const Grading grading = read_grading(entry.path());
            ++count;
            for (double share : {0.05, 0.3, 0.5, 0.9})
                CHECK(grading.passing(grading.size_at(share)) == about(share).epsilon(1e-12));
        }
        CHECK(count == 7);
    }

    TEST_CASE("the mid-range curve is linear in the logarithm of the size") {
        const Grading grading = grading_of("40,100,100\n20,40,60\n10,0,10\n");
        CHECK(grading.passing(0.02) == about(0.5));
        CHECK(grading.passing(std::sqrt(0.04 * 0.02)) == about(0.75));
        CHECK(grading.passing(0.005) == doctest::Approx(0));
    }

    TEST_CASE("a sample has the requested count and follows the curve to half a rock on each "
              "sieve") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = read_grading(assets_folder() / "gradings" / "arema_4.csv");
        for (std::size_t count : {50u, 1000u}) {
            const RockSample sample = sample_rocks(grading, clumps, count, 7);
            CHECK(sample.rocks.size() == count);
            CHECK(sample.smallest_size == about(9.53e-3));
            CHECK(sample.truncated_fraction == about(0.025).epsilon(1e-12));
            const SieveReport report =
                sieve_back(sample.rocks, clumps, grading, sample.truncated_fraction);
            const double greatest = std::max(clumps[0].volume, clumps[1].volume);
            for (std::size_t k = 0; k < report.sieves.size(); ++k) {
                const Sieve& sieve = grading.sieves[k];
                const double half = 0.5 * greatest * std::pow(sieve.size, 3) / sample.solid_volume;
                CHECK(std::abs(report.sieves[k].with_tail - sieve.middle()) <= half + 1e-9);
            }
            if (count == 1000) CHECK(report.within);
        }
    }

    TEST_CASE("rocks below the smallest size are left out, and all clumps are used equally often") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = read_grading(assets_folder() / "gradings" / "arema_4.csv");
        const RockSample sample = sample_rocks(grading, clumps, 500, 1, 0.0127);
        std::ptrdiff_t first = 0;
        for (const RockChoice& rock : sample.rocks) {
            first += rock.clump == 0;
            CHECK(rock.sieve >= 0.0127 * (1 - 1e-9));
        }
        CHECK(std::abs(2 * first - static_cast<std::ptrdiff_t>(sample.rocks.size())) <= 2);
    }

    TEST_CASE("the same seed gives the same rocks, another seed another order") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = grading_of("40,100,100\n20,0,0\n");
        const auto a = sample_rocks(grading, clumps, 40, 1),
                   b = sample_rocks(grading, clumps, 40, 1),
                   c = sample_rocks(grading, clumps, 40, 2);
        bool same = true, other = false;
        for (std::size_t k = 0; k < 40; ++k) {
            same = same && a.rocks[k].sieve == b.rocks[k].sieve &&
                   a.rocks[k].clump == b.rocks[k].clump;
            other = other || a.rocks[k].sieve != c.rocks[k].sieve;
        }
        CHECK(same);
        CHECK(other);
    }

    TEST_CASE("rocks outside the grading band are detected") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = grading_of("40,100,100\n20,40,60\n10,0,10\n");
        const std::vector<RockChoice> coarse(20, {0, 0.03});
        CHECK_FALSE(sieve_back(coarse, clumps, grading).within);
    }

    TEST_CASE("an invalid grading band is refused with its line") {
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n50,0,10\n"), doctest::Contains(":3:"),
                             InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n20,60,40\n"), doctest::Contains(":3:"),
                             InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,120\n20,0,40\n"), doctest::Contains(":2:"),
                             InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n20,10,40\n10,20,30\n"),
                             doctest::Contains(":4:"), InputError);
        CHECK_THROWS_AS(grading_of("40,90,100\n20,10,40\n"), InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n30,-,90\n20,10,40\n"),
                             doctest::Contains(":3: limits: expected two numbers, or -"),
                             InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n20,100,100\n"),
                             doctest::Contains(":3: limits: expected less than 100 %"), InputError);
        // in metres, in micrometres, and sieves that no sample can span
        CHECK_THROWS_WITH_AS(grading_of("0.04,100,100\n0.02,10,40\n"),
                             doctest::Contains("is it in another unit?"), InputError);
        CHECK_THROWS_WITH_AS(grading_of("40000,100,100\n20000,10,40\n"),
                             doctest::Contains("is it in another unit?"), InputError);
        CHECK_THROWS_WITH_AS(grading_of("40,100,100\n1e-300,0,0\n"), doctest::Contains(":3:"),
                             InputError);
    }
}
