#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/options.hpp"
#include "scenarios/library/library_design.hpp"
#include "scenarios/library/library_member.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

/// A library of one specimen of 60 rocks, which is made and tested in two seconds.
struct SmallLibrary {
    LibraryDesign design;
    Triaxial test;
    Common common;
    SpecimenLibrary library;

    explicit SmallLibrary(const TemporaryDirectory& folder) {
        design.specimens = 1;
        design.lowest_porosity = design.highest_porosity = 0.46;
        test.bodies = 60;
        test.least_diameter = 1.5;
        test.grading = (std::filesystem::path(BRIS_SOURCE) / "tests/scenarios/small/grading.csv");
        test.confining_pressure = {55e3, 110e3};
        test.test.porosity_tolerance = 0.1;
        test.test.preparation_friction = 0.7;
        test.test.taps = 0;
        test.test.final_axial_strain = 0.005;
        common.out = folder.path();
        common.scenario = "specimen_library";
        common.threads = 1;
        common.quiet = true;
        Options options;
        design.declare_options(options);
        test.declare_options(options);
        common.settings = options.values();
        common.settings.emplace_back("seed", common.seed);
        library = empty_library(design, test, common);
        complete_library(library, folder / "library.h5", design, test, common);
    }
};

} // namespace

TEST_SUITE("library/library_member") {
    TEST_CASE("the specimens with the largest weights are favoured, the largest first") {
        const auto some = favoured({0.1, 0.4, 0.05, 0.3, 0.15}, 3);
        REQUIRE(some.size() == 3);
        CHECK(some[0].index == 1);
        CHECK(some[1].index == 3);
        CHECK(some[2].index == 4);
        CHECK(some[1].weight == 0.3);
        CHECK(favoured({0.5, 0.5}, 7).size() == 2);
    }

    TEST_CASE("the shipped library says how its specimens were made and tested") {
        const SpecimenLibrary library =
            read_library(assets_folder() / "libraries" / "arema_4_400_rocks.h5");
        const Triaxial test = test_of(library);
        CHECK(test.bodies == 400);
        CHECK(test.confining_pressure == library.pressures);
        CHECK(test.test.preparation == "laboratory");
        CHECK(test.test.longest_preparation == 200000);
        CHECK(test.test.taps == 4);
        SpecimenLibrary odd = library;
        for (NamedValue& v : odd.settings)
            if (v.key == "bodies") v.value = std::string("many");
        CHECK(message_of<InputError>([&] {
                  (void)test_of(odd);
              }).starts_with("the library's settings: bodies: expected a whole number"));
    }

    TEST_CASE("a specimen of a library that is made again and tested has its curve") {
        const TemporaryDirectory folder;
        const SmallLibrary small(folder);
        REQUIRE(small.library.specimens.size() == 1);
        write_library(folder / "library.h5", small.library);
        const SpecimenLibrary library = read_library(folder / "library.h5");
        Common common;
        common.out = folder / "again";
        common.scenario = "smart_triaxial";
        common.threads = 2;
        common.quiet = true;
        const LibrarySpecimen& s = library.specimens.front();
        const PreparedSpecimen packing = make_packing(test_of(library), {s.porosity, s.seed},
                                                      library.settings, common, [](const auto&) {});
        for (std::size_t p = 0; p < 2; ++p) {
            const ModelRun run = run_member(library, 0, packing, library.pressures[p], 1, {});
            REQUIRE(run.curves.size() == 51);
            CHECK(difference_from(library, 0, p, run) < 1e-6); // the library keeps floats
            CHECK(difference_from(library, 0, 1 - p, run) > 0.1);
        }
        const ModelRun half = run_member(library, 0, packing, library.pressures[0], 0.002, {});
        CHECK(half.curves.size() == 21);
        // a second time it is read from its folder
        Common resumed = common;
        resumed.out = folder / "resumed";
        resumed.resume = common.out;
        const PreparedSpecimen read = make_packing(test_of(library), {s.porosity, s.seed},
                                                   library.settings, resumed, [](const auto&) {});
        CHECK(difference_from(library, 0, 0,
                              run_member(library, 0, read, library.pressures[0], 1, {})) < 1e-6);
    }
}
