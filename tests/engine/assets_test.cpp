#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace bris;

TEST_SUITE("engine/assets") {
    TEST_CASE("a file of the assets is found by its name, any other by its path") {
        CHECK(asset_or_file("--grading", "gradings", "arema_4", ".csv") ==
              assets_folder() / "gradings/arema_4.csv");
        const TemporaryDirectory folder;
        const auto own = folder / "own.csv";
        std::ofstream(own) << "x\n";
        CHECK(asset_or_file("--grading", "gradings", own.string(), ".csv") == own);
        const auto message = message_of<InputError>(
            [&] { (void)asset_or_file("--grading", "gradings", "arema_6", ".csv"); });
        CHECK(message.starts_with("--grading: expected arema_24, arema_25, "));
        CHECK(message.ends_with(" or the path of a file, found 'arema_6'"));
    }

    TEST_CASE("programs find the folder that --assets names instead of the one beside them") {
        const TemporaryDirectory folder;
        std::filesystem::create_directories(folder / "mine/gradings");
        std::filesystem::copy(assets_folder() / "clumps", folder / "mine/clumps");
        std::filesystem::copy(assets_folder() / "gradings/arema_5.csv",
                              folder / "mine/gradings/only_this.csv");
        const auto explain = [&](const std::string& grading) {
            return run_process({"triaxial", "--explain", "--assets", (folder / "mine").string(),
                                "--grading", grading, "--bodies", "900"});
        };
        CHECK(explain("only_this").code == 0);
        const Outcome other = explain("arema_4");
        CHECK(other.code == 2);
        CHECK(other.err == "triaxial: --grading: expected only_this, or the path of a file, found "
                           "'arema_4'\n");
        const Outcome none = run_process({"triaxial", "--explain", "--assets=/nowhere"});
        CHECK(none.code == 2);
        CHECK(none.err == "triaxial: --assets: expected a folder, found '/nowhere'\n");
    }

    TEST_CASE("a program that is copied elsewhere finds the assets beside it, or shared ones") {
        const TemporaryDirectory folder;
        namespace fs = std::filesystem;
        for (const char* place : {"bin/assets", "share/bris/assets"}) {
            CAPTURE(place);
            fs::remove_all(folder.path() / "share");
            fs::remove_all(folder.path() / "bin");
            fs::create_directories(folder / "bin");
            fs::create_directories((folder / place).parent_path());
            fs::copy_file(fs::path(BRIS_BINARIES) / "triaxial", folder / "bin/triaxial");
            const std::string program =
                fs::relative(folder / "bin/triaxial", BRIS_BINARIES).string();
            CHECK(run_process({program, "--explain"}).code == 2); // no clumps
            fs::copy(assets_folder(), folder / place, fs::copy_options::recursive);
            CHECK(run_process({program, "--explain"}).code == 0);
        }
    }
}
