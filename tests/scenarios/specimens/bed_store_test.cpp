#include "engine/archive.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/specimens/bed_store.hpp"
#include "scenarios/triaxial/make_specimen.hpp"
#include "tests/quiet_run.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <vector>

using namespace bris;
using testing::quiet_run;

namespace {

namespace fs = std::filesystem;

/// Runs of a small specimen that share a store of beds.
struct Makers {
    TemporaryDirectory folder;

    fs::path beds() const { return folder / "beds"; }
    std::vector<fs::path> kept() const {
        std::vector<fs::path> files;
        if (fs::exists(beds()))
            for (const auto& entry : fs::directory_iterator(beds())) files.push_back(entry.path());
        return files;
    }
    MadeSpecimen make(double friction = 0.7, const fs::path& store = {}) const {
        Common common = quiet_run("triaxial", folder / "out");
        fs::create_directories(common.out);
        common.beds = store.empty() ? beds() : store;
        common.settings = {{"seed", 3}, {"preparation_friction", friction}};
        Triaxial small; // made in a second, as that of tests/scenarios/small/specimen.cfg
        small.grading = BRIS_SOURCE "/tests/scenarios/small/grading.csv";
        small.bodies = 60;
        small.least_diameter = 1.5;
        small.test.porosity = 0.46;
        small.test.porosity_tolerance = 0.1;
        small.test.preparation_friction = friction;
        small.test.taps = 0;
        return make_specimen(make_scene(small, 3), small.test, common, [](const PhaseProgress&) {});
    }
};

} // namespace

TEST_SUITE("specimens/bed_store") {
    TEST_CASE("a specimen asked for twice is made once and has the same bits, another one is made, "
              "and a damaged one is made again") {
        const Makers makers;
        const MadeSpecimen first = makers.make(), second = makers.make();
        CHECK(!first.was_kept);
        CHECK(first.count.steps > 1000);
        CHECK(second.was_kept);
        CHECK(second.count.steps == 0);
        CHECK(second.steps == first.steps);
        CHECK(second.core_porosity == first.core_porosity);
        CHECK(fingerprint(second.state) == fingerprint(first.state));
        CHECK(fs::exists(makers.folder / "out" / specimen_file));
        REQUIRE(makers.kept().size() == 1);

        CHECK(!makers.make(0.6).was_kept);
        REQUIRE(makers.kept().size() == 2);
        for (const fs::path& bed : makers.kept()) fs::resize_file(bed, fs::file_size(bed) / 2);
        const MadeSpecimen again = makers.make();
        CHECK(!again.was_kept);
        CHECK(fingerprint(again.state) == fingerprint(first.state));
        CHECK(makers.make().was_kept);
    }

    TEST_CASE("without a store nothing is kept, and one that cannot be written to ends no run") {
        const Makers makers;
        CHECK(!makers.make(0.7, "none").was_kept);
        CHECK(!fs::exists("none"));
        std::ofstream(makers.folder / "file") << "no folder";
        CHECK(!makers.make(0.7, makers.folder / "file").was_kept);
    }

    TEST_CASE("the beds of the main job are in the assets") {
        const TemporaryDirectory folder;
        const Outcome run =
            run_process({"smart_triaxial", "--confining-pressure", "55e3", "--final-axial-strain",
                         "0.011", "--quiet", "--out", (folder / "out").string()},
                        {}, 120);
        REQUIRE_MESSAGE(run.code == 0, run.err);
        const auto summary = nlohmann::json::parse(read_text(folder / "out" / "summary.json"));
        CHECK(summary.at("preparation_wall_time_s").get<double>() < 5); // 40 to make them
    }

    TEST_CASE("the bits of a bed are those of its version: raise bed_version when they change") {
        const Makers makers;
        CHECK(bed_version == 1);
        CHECK(hexadecimal(fingerprint(makers.make().state)) == "81fce6d18e740326");
    }
}
