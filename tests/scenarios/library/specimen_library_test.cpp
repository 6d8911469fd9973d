#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/library/library_design.hpp"
#include "scenarios/library/specimen_library.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace bris;

namespace {

bool same(const LibraryTest& a, const LibraryTest& b) {
    return a.q == b.q && a.smoothed_q == b.smoothed_q && a.volume == b.volume &&
           a.rings == b.rings && a.sensors == b.sensors && a.field == b.field;
}

bool same(const SpecimenLibrary& a, const SpecimenLibrary& b) {
    if (a.pressures != b.pressures || a.given_up != b.given_up || a.rings != b.rings ||
        a.sensors != b.sensors || a.specimens.size() != b.specimens.size())
        return false;
    for (std::size_t k = 0; k < a.specimens.size(); ++k) {
        const auto &x = a.specimens[k], &y = b.specimens[k];
        if (x.number != y.number || x.seed != y.seed || x.redrawn != y.redrawn ||
            x.rocks.friction != y.rocks.friction || x.rocks.stiffness != y.rocks.stiffness ||
            x.porosity != y.porosity || x.core_porosity != y.core_porosity ||
            x.diameter != y.diameter || x.tests.size() != y.tests.size())
            return false;
        for (std::size_t p = 0; p < x.tests.size(); ++p)
            if (!same(x.tests[p], y.tests[p])) return false;
    }
    return true;
}

} // namespace

TEST_SUITE("library/specimen_library") {
    TEST_CASE("a library that was written is read with the same bits") {
        const TemporaryDirectory folder;
        SpecimenLibrary library = testing::synthetic_library(5, 2);
        library.given_up = {3, 9};
        write_library(folder / "a.h5", library);
        const SpecimenLibrary read = read_library(folder / "a.h5");
        CHECK(same(read, library));
        CHECK(read.settings.front().key == "bodies");
        SpecimenLibrary none = library;
        none.specimens.clear();
        none.given_up.clear();
        write_library(folder / "none.h5", none);
        CHECK(same(read_library(folder / "none.h5"), none));
    }

    TEST_CASE("a damaged library and a file of another kind are refused, with the name of the "
              "file") {
        const TemporaryDirectory folder;
        write_library(folder / "a.h5", testing::synthetic_library(5, 2));
        std::string bytes = read_whole(folder / "a.h5");
        bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
        write_whole(folder / "damaged.h5", bytes);
        const auto message = [&](const char* name) {
            return message_of<InputError>([&] { (void)read_library(folder / name); });
        };
        CHECK(message("damaged.h5").find("damaged.h5") != std::string::npos);
        write_whole(folder / "short.h5", bytes.substr(0, 1000));
        CHECK(message("short.h5").find("short.h5") != std::string::npos);
        CHECK_THROWS_AS(read_library(folder / "missing.h5"), OutputError);
    }

    TEST_CASE("specimens are kept in the order of their numbers, whichever is done first") {
        SpecimenLibrary library = testing::synthetic_library(4, 1), shuffled = library;
        shuffled.specimens.clear();
        for (const std::size_t k : {2u, 0u, 3u, 1u}) shuffled.add(library.specimens[k]);
        CHECK(same(library, shuffled));
        CHECK(library.has(4));
        CHECK_FALSE(library.has(5));
        library.given_up = {5};
        CHECK(library.has(5));
    }

    TEST_CASE("a run is sampled at the strains of the library") {
        const ModelRun run = testing::steady_run(); // 1 % in 100 stages
        const LibraryAxis axis{.step = 1e-3, .count = 10, .every = 5};
        const LibraryTest test = sampled(run, axis);
        REQUIRE(test.q.size() == 10);
        for (std::size_t k = 0; k < 10; ++k) {
            const double stage = 10 * static_cast<double>(k + 1);
            CHECK(double{test.q[k]} == about(1e5 * (1 - std::exp(-stage / 20))).epsilon(1e-6));
            CHECK(double{test.volume[k]} == about(-1e-5 * stage).epsilon(1e-6));
            CHECK(double{test.rings[8 * k + 3]} == about(1e-6 * stage / 0.075).epsilon(1e-6));
        }
        double sum = 0; // stages 25 to 75 around 0.5 %
        for (int stage = 25; stage <= 75; ++stage) sum += 1e5 * (1 - std::exp(-stage / 20.0));
        CHECK(double{test.smoothed_q[4]} == about(sum / 51).epsilon(1e-6));
        // sensor rock 0 at (0, 0.05): outward is y, sideways -x; it moved by 1e-3 (1, 0, -1)
        REQUIRE(test.sensors.size() == 2 * 3 * 6);
        const std::size_t last = 3 * 6;
        CHECK(std::abs(test.sensors[last]) < 1e-9);
        CHECK(double{test.sensors[last + 1]} == about(-1e-3).epsilon(1e-6));
        CHECK(double{test.sensors[last + 2]} == about(-1e-3).epsilon(1e-6));
        CHECK(double{test.sensors[last + 5]} == about(0.1).epsilon(1e-6));
        // all three rocks are in the topmost cells and move down by 1e-3
        const std::size_t top = 2 * FieldCells::count + 2 * FieldCells::radii * 7;
        double down = 0;
        for (std::size_t r = 0; r < FieldCells::radii; ++r)
            down = std::min(down, double{test.field[top + 2 * r + 1]});
        CHECK(down == about(-1e-3).epsilon(1e-6));
        CHECK_THROWS_AS(sampled(run, {.step = 1e-3, .count = 11, .every = 5}), InputError);
        CHECK_THROWS_AS(sampled(run, {.step = 1.5e-4, .count = 3, .every = 1}), InputError);
    }

    TEST_CASE("the points of a design lie in its ranges, and no packing has the seed of another") {
        const LibraryDesign design;
        std::set<std::uint64_t> seeds;
        double friction = 0;
        for (const std::uint64_t seed : {1u, 2u, 5001u})
            for (std::uint64_t number = 1; number <= 80; ++number)
                for (std::uint64_t attempt = 0; attempt < design.packings; ++attempt) {
                    const DesignPoint p = design_point(design, number, attempt, seed);
                    seeds.insert(p.seed);
                    CHECK((p.rocks.friction >= 0.4 && p.rocks.friction <= 1));
                    CHECK((p.rocks.stiffness >= 0.4 && p.rocks.stiffness <= 1.6));
                    CHECK((p.porosity >= 0.36 && p.porosity <= 0.42));
                    // an attempt has another packing, but the same parameters
                    CHECK(p.rocks.friction == design_point(design, number, 0, seed).rocks.friction);
                    friction += std::log(p.rocks.friction) / (3.0 * 80 * design.packings);
                }
        CHECK(seeds.size() == 3 * 80 * design.packings);
        CHECK(*seeds.begin() > 1000000000);
        CHECK(friction == about(std::log(0.4) / 2).epsilon(0.02)); // the middle of the logarithms
        CHECK(design_point(design, 1, 0, 1).rocks.friction !=
              design_point(design, 1, 0, 2).rocks.friction);
    }

    TEST_CASE("contradictory designs are refused by name") {
        const auto message = [](LibraryDesign design, Triaxial test) {
            return message_of<InputError>([&] { check_design(design, test); });
        };
        CHECK(message({}, {}).empty());
        CHECK(message({.lowest_friction = 2}, {}).starts_with("--lowest-friction"));
        CHECK(message({.strain_step = 1.5e-4}, {}).starts_with("--strain-step"));
        CHECK(message({.strain_step = 3e-3}, {}).starts_with("--final-axial-strain"));
        Triaxial test;
        test.test.porosity = 0.4;
        CHECK(message({}, test).starts_with("--porosity"));
    }
}
