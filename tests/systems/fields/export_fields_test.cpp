// The scenario export_fields as a user starts it.

#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("fields/export_fields") {
    TEST_CASE("fields that cannot be exported are refused before anything is written") {
        const TemporaryDirectory folder;
        const auto run = (folder / "run").string(), out = (folder / "out").string();
        REQUIRE(run_process(
                    {"settle", "--spheres", "20", "--duration", "0.001", "--quiet", "--out", run})
                    .code == 0);
        const auto exported = [&](const std::string& option, const std::string& value) {
            return run_process({"export_fields", "--from", run + "/settle.ckpt.h5", option, value,
                                "--quiet", "--out", out});
        };
        for (const auto& [option, value, what] :
             {std::array<const char*, 3>{"--fields", "porosity,porosity", "each name once"},
              {"--voxel", "1", "larger than the scene?"}}) {
            const Outcome outcome = exported(option, value);
            CAPTURE(outcome.err);
            CHECK(outcome.code == 2);
            CHECK(is_one_line_of(outcome.err, "export_fields"));
            CHECK(outcome.err.find(what) != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(out));
        }
        CHECK(exported("--voxel", "0.005").code == 0);
    }
}
