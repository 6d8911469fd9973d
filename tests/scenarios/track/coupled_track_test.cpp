// Bays below the ties of a track, coupled by the rails: with beds that follow the law of
// settlement, whose end is known, and with bays of ballast.

#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/track/coupled_track.hpp"
#include "tests/about.hpp"
#include "tests/quiet_run.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double even = 90e3, exponent = 2.5; // N, the load at which `each` is settled

/// A bed that settles by the law: `each` (m) under an axle that loads it with `even`.
class LawBed : public BedBelowTie {
public:
    LawBed(double each, double stiffness) : each_(each), stiffness_(stiffness) {}
    void prepare(const ReportProgress&) override {}
    double load(double force, unsigned axles) override {
        const double by = axles * each_ * std::pow((force + weight_of_tie) / even, exponent);
        settled_ += by;
        return by;
    }
    double stiffness() const override { return settled_ > 0 ? stiffness_ : 0; }
    void save(const std::filesystem::path& path) const override {
        Checkpoint checkpoint{"bed", 0, {}, {}};
        checkpoint.state.put("settled", std::span<const double>(&settled_, 1));
        write_checkpoint(path, checkpoint);
    }
    void resume(const std::filesystem::path& path) override {
        settled_ = read_checkpoint(path).state.get<double>("settled").front();
    }

private:
    double each_, stiffness_, settled_ = 0;
};

CoupledTrack law_track(unsigned mud_ties, double ratio, unsigned cycles) {
    return {.stretch = {.mud_ties = mud_ties, .axle_load = 316e3},
            .law = {.ratio = ratio, .exponent = exponent, .scatter = 0},
            .bays = 9,
            .cycles = cycles,
            .pad_stiffness = 1e9};
}

/// With beds that have 30 MN/m with their pads.
CoupledHistory couple(const CoupledTrack& track, const std::filesystem::path& out, double each,
                      const std::filesystem::path& from = {}, unsigned threads = 1) {
    std::filesystem::create_directories(out);
    Common common = bris::testing::quiet_run("track", out);
    common.resume = from;
    common.threads = threads;
    const double bed = 1 / (1 / 30e6 - 1 / track.pad_stiffness);
    return couple_beds(track,
                       [&](std::size_t tie, const Common&) {
                           const double r = track.stretch.is_mud(tie) ? track.law.ratio : 1;
                           return std::make_unique<LawBed>(r * each, bed);
                       },
                       common, {"cycles"});
}

BallastBox small_bay(const char* run) {
    BallastBox box;
    box.run = run;
    box.width = tie_spacing;
    box.rock_scale = 3;
    box.porosity = 0.45;
    box.steps_per_cycle = 4000;
    box.fouling.settings.voxel = 0.03;
    return box;
}

} // namespace

TEST_SUITE("track/coupled_track") {
    TEST_CASE("bays that are replaced by the law of settlement give what the law alone gives") {
        const TemporaryDirectory folder;
        const CoupledTrack track = law_track(1, 4, 400);
        const StretchState coupled = couple(track, folder.path(), 2e-5).states.back();
        const StretchState alone =
            settle_track({track.stretch, track.law, 0.02}, {coupled.settled}, 1).front();
        const std::size_t middle = track.stretch.ties / 2;
        MESSAGE("settled ", 1e3 * coupled.settled, " mm, load ", coupled.loads[middle], " and ",
                alone.loads[middle]);
        CHECK(coupled.settled > 2e-3);
        CHECK(coupled.loads[middle] == about(alone.loads[middle]).epsilon(0.01));
        CHECK(coupled.loads[middle - 1] == about(alone.loads[middle - 1]).epsilon(0.01));
        CHECK(std::abs(coupled.voids[middle] - alone.voids[middle]) < 0.03 * alone.voids[middle]);
    }

    TEST_CASE("without mud all ties settle as one, and the ratio of equal bays is 1") {
        const TemporaryDirectory folder;
        const CoupledTrack track = law_track(3, 1, 30);
        const CoupledHistory history = couple(track, folder.path(), 1e-5);
        for (const double void_below : history.states.back().voids) CHECK(void_below < 1e-8);
        CHECK(ratio_of_bays(track, history) == about(1).epsilon(1e-6));
        CHECK(ratio_of_bays(law_track(3, 3, 30), couple(law_track(3, 3, 30), folder / "mud",
                                                        1e-5)) == about(3).epsilon(1e-6));
    }

    TEST_CASE("a run that goes on from its checkpoint has the same bits, with any number of "
              "threads, and blocks end after ten axles or as levels change") {
        const TemporaryDirectory folder;
        const CoupledHistory whole = couple(law_track(3, 4, 90), folder / "whole", 2e-5, {}, 2);
        couple(law_track(3, 4, 40), folder / "part", 2e-5);
        const CoupledHistory resumed =
            couple(law_track(3, 4, 90), folder / "rest", 2e-5, folder / "part");
        const auto &a = whole.states.back(), &b = resumed.states.back();
        CHECK(b.cycles == 90);
        double before = 0;
        for (std::size_t k = 1; k < whole.states.size(); ++k) {
            const double axles = whole.states[k].cycles - before;
            CHECK(axles >= 1);
            CHECK(axles <= 10);
            before = whole.states[k].cycles;
        }
        // the block in which the first part ended was shorter, so only what a block may change
        CHECK(a.voids[20] == about(b.voids[20]).epsilon(0.02));
        const CoupledHistory again =
            couple(law_track(3, 4, 90), folder / "again", 2e-5, folder / "part", 2);
        CHECK(again.states.back().voids == b.voids);
        CHECK(again.blocks.size() == resumed.blocks.size());
        CHECK(refusal_of([&] {
                  (void)couple(law_track(3, 4, 20), folder / "less", 2e-5, folder / "part");
              }).starts_with("--cycles: expected at least the 40"));
    }

    TEST_CASE("tracks whose bays and mud do not fit together are refused") {
        CoupledTrack track = law_track(3, 4, 10);
        track.mud.run = "II.3";
        track.bays = 8;
        CHECK(refusal_of([&] { check_coupled(track); }).starts_with("--bays: expected at most"));
        track.bays = 3;
        CHECK(refusal_of([&] { check_coupled(track); }).starts_with("--bays: expected more than"));
        track.bays = 5;
        CHECK(refusal_of([&] { check_coupled(track); }) == "");
        track.mud.run = "I.3";
        CHECK(refusal_of([&] { check_coupled(track); }).starts_with("--mud-run"));
    }
}

TEST_SUITE("slow") {
    TEST_CASE("bays of ballast below rails settle, stiffen what carries the track, and go on from "
              "a checkpoint to the same bits") {
        const TemporaryDirectory folder;
        CoupledTrack track = {.stretch = {.ties = 11, .mud_ties = 1},
                              .law = {.scatter = 0},
                              .clean = small_bay("I.2"),
                              .mud = small_bay("II.3"),
                              .bays = 3,
                              .cycles = 3};
        const auto run = [&](const char* name, unsigned threads, const char* from = nullptr) {
            std::filesystem::create_directories(folder / name);
            Common common = bris::testing::quiet_run("track", folder / name);
            common.threads = threads;
            if (from != nullptr) common.resume = folder / from;
            return couple_bays(track, common, {"cycles"});
        };
        const CoupledHistory whole = run("whole", 2);
        REQUIRE(whole.blocks.size() >= 3);
        for (const BayBlock& b : whole.blocks) {
            CHECK(b.load > 0);
            CHECK(b.load < 160e3);
            CHECK(b.stiffness > 5e6);
            CHECK(b.stiffness < 500e6);
        }
        CHECK(whole.states.back().settled > 0);
        track.cycles = 1; // the first block has one axle
        run("part", 1);
        track.cycles = 3;
        const CoupledHistory resumed = run("rest", 1, "part");
        CHECK(resumed.states.back().settlements == whole.states.back().settlements);
        CHECK(resumed.blocks.back().stiffness == whole.blocks.back().stiffness);
        for (const char* name : {"whole", "rest"})
            CHECK(std::filesystem::exists(folder / name / "tie_05" / "bay_3.ckpt.h5"));
    }
}
