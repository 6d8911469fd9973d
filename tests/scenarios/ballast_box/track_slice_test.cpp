// Trains over a small slice of track, from the first rock on.
#include "engine/io/checkpoint.hpp"
#include "scenarios/ballast_box/track_slice.hpp"
#include "tests/about.hpp"
#include "tests/quiet_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

TrackSlice small_slice() {
    TrackSlice slice;
    slice.box.rock_scale = 2;
    slice.box.width = 0.26;
    slice.box.porosity = 0.42;
    slice.box.steps_per_cycle = 6000;
    return slice;
}

Train two_bogies(double load) {
    return {.name = "two bogies", .axles = {{0, load}, {1.8, load}, {14, load}, {15.8, load}}};
}

PassageRecord run(const std::filesystem::path& out, const std::vector<Train>& trains,
                  const std::filesystem::path& from = {}) {
    std::filesystem::create_directories(out);
    const Common common = bris::testing::quiet_run("forecast", out);
    return run_trains(small_slice(), trains, common, "slice", from, {},
                      [](const PhaseProgress&) {});
}

std::string bits_of(const std::filesystem::path& out) {
    return hexadecimal(fingerprint(read_checkpoint(out / "slice.ckpt.h5").state));
}

} // namespace

TEST_SUITE("slow") {
    TEST_CASE("a heavier train presses the ballast down further, and a passage that goes on from a "
              "checkpoint has the same bits") {
        const TemporaryDirectory folder;
        const auto light = two_bogies(100e3), heavy = two_bogies(300e3);
        run(folder / "first", {light, light}); // the first passage settles the new bed
        const PassageRecord apart =
            run(folder / "apart", {light, light, heavy}, folder / "first" / "slice.ckpt.h5");
        const PassageRecord whole = run(folder / "whole", {light, light, heavy});
        CHECK(bits_of(folder / "apart") == bits_of(folder / "whole"));
        REQUIRE(whole.passages.size() == 3);
        const auto &under_light = whole.passages[1], &under_heavy = whole.passages[2];
        REQUIRE(under_heavy.rocks.size() == 6);
        for (std::size_t k = 0; k < under_heavy.rocks.size(); ++k)
            CHECK(apart.passages[2].rocks[k].deflection == under_heavy.rocks[k].deflection);
        CHECK(under_light.tie.deflection > 1e-5);
        CHECK(under_heavy.tie.deflection > 1.5 * under_light.tie.deflection);
        CHECK(under_heavy.tie.deflection < 0.03);
        // two axles of a bogie press a tie with about 0.4 axle loads
        for (const auto& [passage, load] : {std::pair{under_light, 40e3}, {under_heavy, 120e3}})
            CHECK(passage.tie.compliance * load == about(passage.tie.deflection).epsilon(0.5));
        // most of the settlement is that of the first passage over a new bed
        CHECK(under_light.tie.settlement < 0.5 * whole.passages[0].tie.settlement);
    }
}
