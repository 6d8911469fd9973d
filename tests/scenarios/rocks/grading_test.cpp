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

Grading grading_in(const std::string& text) {
    const TemporaryDirectory folder;
    const auto path = folder / "grading.csv";
    std::ofstream(path) << text;
    return read_grading(path);
}

Grading grading_of(const std::string& rows) {
    return grading_in("sieve_mm,lower_percent,upper_percent\n" + rows);
}

std::string refusal_of(const std::string& text) {
    const std::string message = message_of<InputError>([&] { (void)grading_in(text); });
    return message.substr(message.find("grading.csv"));
}

/// A field sample of fouled ballast, sieved to 0.075 mm.
const std::string fouled = "63,100,100\n50,88,88\n40,55,55\n31.5,32,32\n22.4,20,20\n9.5,13,13\n"
                           "4.75,9,9\n0.425,4,4\n0.075,2,2\n";

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
        CHECK_THROWS_WITH_AS(grading_of("40,60,90\n20,10,40\n"),
                             doctest::Contains(":2: expected at least 80 % to pass the coarsest"),
                             InputError);
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

    TEST_CASE("sieve tables as laboratories write them give the same curve, and say how they were "
              "read") {
        const std::string numbers = "63,100\n50,88.4\n40,45.2\n31.5,12.1\n22.4,1.3\n";
        const Grading plain = grading_of("63,100,100\n50,88.4,88.4\n40,45.2,45.2\n31.5,12.1,12.1\n"
                                         "22.4,1.3,1.3\n");
        CHECK(plain.read_as.empty());
        struct Form {
            const char* text;
            const char* read_as;
        };
        for (const Form& form :
             {Form{"sieve_mm,lower_percent,upper_percent\n22.4,1.3,1.3\n31.5,12.1,12.1\n"
                   "40,45.2,45.2\n50,88.4,88.4\n63,100,100\n",
                   "sieves from fine to coarse"},
              Form{"sieve size [mm],passing [%]\n63,100\n50,88.4\n40,45.2\n31.5,12.1\n22.4,1.3\n",
                   "'passing [%]' as passing"},
              Form{"size_um,passing\n63000,1\n50000,.884\n40000,.452\n31500,.121\n22400,.013\n",
                   "'passing' as fractions of the mass, 'passing' as passing"},
              Form{"Sieve (mm);Retained (%);Cumulative passing (%)\n63;0,0;100,0\n50;11,6;88,4\n"
                   "40;43,2;45,2\n31,5;33,1;12,1\n22,4;10,8;1,3\npan;1,3;0\n",
                   "semicolons and decimal commas, 'Cumulative passing (%)' as passing, 'Retained "
                   "(%)' as retained on each sieve"},
              Form{"opening\tretained %\n63\t0\n50\t11,6\n40\t43,2\n31,5\t33,1\n22,4\t10,8\n"
                   "pan\t1,3\n",
                   "tabs and decimal commas, 'retained %' as retained on each sieve"},
              Form{"sieve_mm,cumulative retained\n63,0\n50,11.6\n40,54.8\n31.5,87.9\n22.4,98.7\n",
                   "'cumulative retained' as percent, 'cumulative retained' as retained on each "
                   "sieve and all coarser ones"}}) {
            CAPTURE(form.text);
            const Grading read = grading_in(form.text);
            REQUIRE(read.sieves.size() == plain.sieves.size());
            for (std::size_t k = 0; k < plain.sieves.size(); ++k) {
                CHECK(read.sieves[k].size == about(plain.sieves[k].size));
                CHECK(std::abs(read.sieves[k].lower - plain.sieves[k].lower) < 1e-12);
                CHECK(std::abs(read.sieves[k].upper - plain.sieves[k].upper) < 1e-12);
            }
            CHECK(read.read_as == form.read_as);
        }
    }

    TEST_CASE("what the coarsest sieve retains is on the curve's straight continuation") {
        const Grading grading = grading_of("65,95,100\n40,40,60\n20,0,2\n");
        REQUIRE(grading.sieves.size() == 4);
        // from half at 40 mm to 97.5 % at 65 mm, on a logarithmic scale
        const double all = 0.065 * std::pow(65.0 / 40, 2.5 / 47.5);
        CHECK(grading.sieves.front().size == about(all).epsilon(1e-12));
        CHECK(grading.passing(all) == 1);
        CHECK(grading.passing(0.065) == about(0.975).epsilon(1e-12));
        CHECK(grading.passing(std::sqrt(all * 0.065)) == about(0.9875).epsilon(1e-9));
        CHECK(grading.read_as == "2.5 % retained on the coarsest sieve as rocks of up to 66.7 mm");
        CHECK(grading_of("40,90,90\n20,90,90\n10,0,0\n").sieves.front().size == about(0.08));
    }

    TEST_CASE("a sieve table that may mean two things is refused, and says what to state") {
        CHECK(refusal_of("sieve_mm,passing\n40,3\n20,1\n") ==
              "grading.csv: column 'passing': expected the unit in the title, as 'passing [%]', "
              "found numbers up to 3, which may be percent or fractions");
        // a stated unit is not overridden
        CHECK(refusal_of("sieve_mm,passing [%]\n40,1\n20,0.4\n")
                  .starts_with("grading.csv:2: expected at least 80 % to pass the coarsest sieve, "
                               "found 1 %"));
        CHECK(
            refusal_of("sieve_mm,retained [g]\n40,0\n20,812\npan,100\n")
                .starts_with("grading.csv: column 'retained [g]': expected percent or a fraction"));
        CHECK(refusal_of("sieve [furlong],passing [%]\n40,100\n20,4\n")
                  .starts_with("grading.csv: column 'sieve [furlong]': expected mm, cm, m, um or"));
        CHECK(
            refusal_of("sieve_mm,retained [%]\n40,0\n20,10\n10,30\n")
                .find("expected shares that add up to 100 %, or a title with the word cumulative, "
                      "found 40.0 %") != std::string::npos);
        CHECK(
            refusal_of("sieve_mm;passing [%];retained [%]\n40;100;0\n20;60,5;30\n10;10;60\npan;0;10"
                       "\n") == "grading.csv:3: expected the same from passing and retained "
                                "masses, found 60.5 and 70.0 % passing");
        CHECK(refusal_of("sieve_mm;passing [%]\n40;100\n20.5;60,5\n") ==
              "grading.csv:3: expected decimal points or decimal commas, found both");
        CHECK(refusal_of("sieve_mm,passing [%]\n40,100\n50,60\n20,10\n") ==
              "grading.csv:3: sieve: expected sizes that decrease, or increase, from line to line, "
              "found 50 after 40");
        CHECK(refusal_of("sieve_mm,mass\n40,100\n20,10\n") ==
              "grading.csv: expected a column 'lower_percent', found sieve_mm, mass");
        CHECK(refusal_of("sieve_mm,lower_percent,ypper_percent\n40,100,100\n20,0,10\n") ==
              "grading.csv: expected a column 'upper_percent', found sieve_mm, lower_percent, "
              "ypper_percent");
    }

    TEST_CASE("rocks are counted as they are drawn") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = read_grading(assets_folder() / "gradings" / "arema_4.csv");
        for (const double smallest : {0.0, 0.0127}) {
            const RockSample sample = sample_rocks(grading, clumps, 5000, 7, smallest);
            CHECK(expected_rocks(grading, clumps, sample.solid_volume, smallest) ==
                  about(5000).epsilon(5e-3));
        }
    }

    TEST_CASE("rocks that are too many are refused before they are drawn, with the sieve at which "
              "to cut") {
        const std::vector<Clump> clumps = two_clumps();
        const Grading grading = grading_of(fouled);
        CHECK(expected_rocks(grading, clumps, 0.1) > 1e9);
        const auto [sieve, rocks] = cut_for(grading, clumps, 0.1, 1e4);
        CHECK(sieve == about(9.5e-3));
        CHECK(rocks == about(expected_rocks(grading, clumps, 0.1, 9.5e-3)));
        CHECK(expected_rocks(grading, clumps, 0.1, 4.75e-3) > 1e4);
        require_countable(grading, clumps, 0.1, 9.5e-3, "--smallest-rock");
        CHECK(message_of<InputError>([&] {
                  require_countable(grading, clumps, 0.1, 0, "--smallest-rock");
              }).find("cut at its sieve of ") != std::string::npos);
    }
}
