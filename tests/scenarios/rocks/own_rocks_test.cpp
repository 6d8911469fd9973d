#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

using namespace bris;

namespace {

/// A folder of two shapes as the scenario clumps writes it, with a cube and a report.
struct OwnClumps {
    TemporaryDirectory folder;
    OwnClumps() {
        const auto all = clumps_of({});
        for (const auto& [from, to] : {std::pair{"rock_03", "mine_a"}, {"rock_07", "mine_b"}}) {
            const auto clump = std::ranges::find(all, std::string(from), &Clump::name);
            write_clump(folder / (std::string(to) + ".csv"), *clump, {"own"});
        }
        std::filesystem::copy(assets_folder() / "clumps/cube.csv", folder / "cube.csv");
        std::ofstream(folder / "report.csv") << "not a clump\n";
    }
};

} // namespace

TEST_SUITE("rocks/own_rocks") {
    TEST_CASE("a triaxial scene has the rocks, the grading and the sensor shapes that options "
              "name") {
        const OwnClumps own;
        const auto grading = own.folder / "sieves.csv";
        std::filesystem::copy(assets_folder() / "gradings/arema_5.csv", grading);
        std::filesystem::create_directories(own.folder / "library");
        for (const char* name : {"mine_a.csv", "mine_b.csv", "cube.csv"})
            std::filesystem::copy(own.folder / name, own.folder / "library" / name);
        Triaxial t;
        t.bodies = 900;
        t.clumps = own.folder / "library";
        t.grading = grading.string();
        const TriaxialScene standard = make_scene(t, 1);
        REQUIRE(standard.clumps.size() == 2); // without the cube
        CHECK(standard.clumps[0].name == "mine_a");
        CHECK(standard.smart_rocks.at(0).name == "rock_01"); // of assets/clumps
        CHECK(standard.grading.name == "sieves");
        CHECK(standard.grading.sieves.front().size == read_grading(grading).sieves.front().size);
        t.sensor_shape = "mine_b,cube," + (own.folder / "mine_a.csv").string();
        const TriaxialScene shaped = make_scene(t, 1);
        REQUIRE(shaped.smart_rocks.size() == 3);
        CHECK(shaped.smart_rocks[0].name == "mine_b");
        CHECK(shaped.smart_rocks[1].name == "cube");
        CHECK(shaped.smart_rocks[2].name == "mine_a");
    }

    TEST_CASE("a name that is neither in the assets nor a file is refused with what there is") {
        CHECK(message_of<InputError>([] {
                  (void)grading_named("arema_9");
              }).starts_with("--grading: expected arema_24, "));
        CHECK(message_of<InputError>([] {
                  (void)sensor_shapes_named("rock_99", clumps_of({}), "--sensor-shape");
              }).starts_with("--sensor-shape: expected cube, rock_01, "));
        CHECK_THROWS_WITH_AS((void)clumps_of("/nowhere"),
                             "/nowhere: expected a directory with clumps (*.csv), found none",
                             InputError);
    }
}
