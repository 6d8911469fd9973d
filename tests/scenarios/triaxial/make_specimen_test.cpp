#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/triaxial/make_specimen.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

using namespace bris;

TEST_SUITE("triaxial/make_specimen") {
    TEST_CASE("a specimen serves any recordings whose sensor rocks were placed as in it, and no "
              "others") {
        namespace fs = std::filesystem;
        const TemporaryDirectory folder;
        const fs::path example = assets_folder() / "smartrock", file = folder / "specimen.ckpt.h5";
        const auto common_with = [&](const fs::path& recordings) {
            Common common;
            common.scenario = "smart_triaxial";
            common.resume = file;
            common.settings = {{"seed", std::string("1")}, {"recordings", recordings.string()}};
            return common;
        };
        const auto save = [&](const std::string& poses) {
            write_checkpoint(
                file, {"specimen", 1, {{"seed", std::string("1")}, {"recorded_poses", poses}}, {}});
        };
        save("none");
        const std::string message =
            message_of<InputError>([&] { require_same_specimen(common_with(example)); });
        const std::string_view asked = "this run asks for recorded_poses ";
        REQUIRE(message.find(asked) != std::string::npos);
        save(message.substr(message.find(asked) + asked.size()));
        CHECK_NOTHROW(require_same_specimen(common_with(example)));

        fs::create_directory(folder / "other"); // other recordings of sensors in the same places
        for (const auto& entry : fs::directory_iterator(example))
            if (entry.path().extension() == ".txt")
                fs::copy(entry.path(), folder / "other" / entry.path().filename());
        CHECK_NOTHROW(require_same_specimen(common_with(folder / "other")));
        SensorInfo moved = read_sensor_info(folder / "other/rock_04.txt");
        moved.placed_x += 1e-3;
        write_sensor_info(folder / "other/rock_04.txt", moved);
        CHECK_THROWS_WITH_AS(require_same_specimen(common_with(folder / "other")),
                             doctest::Contains("this run asks for recorded_poses 10 ("),
                             InputError);
    }
}
