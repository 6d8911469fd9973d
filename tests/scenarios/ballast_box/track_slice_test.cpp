// Trains over a small slice of track, from the first rock on.
#include "engine/io/checkpoint.hpp"
#include "scenarios/ballast_box/track_slice.hpp"
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
    Common common;
    common.scenario = "forecast";
    common.out = out;
    common.threads = 1;
    common.quiet = true;
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
        run(folder / "first", {light});
        const PassageRecord apart =
            run(folder / "apart", {light, heavy}, folder / "first" / "slice.ckpt.h5");
        const PassageRecord whole = run(folder / "whole", {light, heavy});
        CHECK(bits_of(folder / "apart") == bits_of(folder / "whole"));
        REQUIRE(whole.passages.size() == 2);
        const auto &first = whole.passages[0], &second = whole.passages[1];
        REQUIRE(first.rocks.size() == 6);
        for (std::size_t k = 0; k < first.rocks.size(); ++k) {
            CHECK(apart.passages[1].rocks[k].deflection == second.rocks[k].deflection);
        }
        CHECK(second.tie.deflection > 1.5 * first.tie.deflection);
        CHECK(first.tie.deflection > 1e-5);
        for (const PassageMovements* p : {&first, &second}) {
            const double load = p == &first ? 100e3 : 300e3;
            CHECK(p->tie.compliance * 0.4 * load > 0.5 * p->tie.deflection);
            CHECK(p->tie.compliance * 0.4 * load < 2 * p->tie.deflection);
        }
        CHECK(second.tie.deflection < 0.03);
        // the same train once more moves less: most of the settlement is that of the first passage
        const PassageRecord again =
            run(folder / "again", {light, heavy, heavy}, folder / "apart" / "slice.ckpt.h5");
        CHECK(again.passages[2].tie.settlement < second.tie.settlement);
    }
}
