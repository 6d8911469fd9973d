// Push of a short tie through a small bed.
#include "components/kinds.hpp"
#include "engine/run.hpp"
#include "scenarios/field_tests/tie_bed.hpp"
#include "scenarios/specimens/bench.hpp"
#include "scenarios/specimens/scene.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

using namespace bris;
using namespace bris::testing;

namespace {

Common quiet_in(const std::filesystem::path& out) {
    Common common;
    common.scenario = "tie_push";
    common.out = out;
    common.threads = 1;
    common.quiet = true;
    return common;
}

TieBed small_bed() {
    TieBed bed;
    bed.tie_length = 0.3;
    bed.tie_mass = 100;
    bed.base = 0.15;
    bed.shoulder = 0.1;
    bed.rocks.scale = 1.2;
    bed.porosity = 0.46;
    bed.displacement = 2e-3;
    bed.speed = 0.05;
    bed.interval = 1e-4;
    return bed;
}

struct PushedTie {
    PushedTie(const TieBed& settings, const TieTest& of, const Archive& made, unsigned threads,
              const std::filesystem::path& out)
        : bed(settings), test(of), simulation(make_tie_bed(bed, 1, threads, false)),
          run(simulation, quiet_in(out), "tie_push"), curve("push", push_columns()) {
        run.keep(curve);
        simulation.restore(made);
    }
    void go(const char* checkpoint_on_the_way = nullptr) {
        run.go(push_phases(bed, test, curve, [&, this](const World&) {
            if (checkpoint_on_the_way != nullptr && curve.rows() == 11)
                run.save_as(checkpoint_on_the_way);
        }));
    }
    std::uint64_t fingerprint() const { return bris::fingerprint(simulation.snapshot()); }

    TieBed bed;
    TieTest test;
    Simulation simulation;
    Run run;
    Series curve;
};

} // namespace

TEST_SUITE("tie_push") {
    TEST_CASE("the ballast carries a tie at rest, resists its push at base, crib and end, with the "
              "same bits for any threads and after resuming, and less without a shoulder") {
        const TemporaryDirectory folder;
        const TieBed bed = small_bed();
        Simulation making = make_tie_bed(bed, 1, 1, false);
        Run of_bed(making, quiet_in(folder.path()), "specimen");
        of_bed.go(make_bed_phases());
        const Archive made = making.snapshot();
        CHECK(std::as_const(making).world().resource<RockBedState>().porosity <
              bed.porosity + bed.porosity_tolerance);

        PushedTie one(bed, {}, made, 1, folder.path());
        one.go("middle");
        const auto column = [](const PushedTie& tie, const char* name) -> const auto& {
            return tie.curve.column(name);
        };
        REQUIRE(one.curve.rows() == 21);
        CHECK(column(one, "support").front() == about(9.81 * bed.tie_mass).epsilon(0.05));
        for (std::size_t k = 0; k < one.curve.rows(); ++k)
            CHECK(column(one, "force")[k] ==
                  about(column(one, "base_force")[k] + column(one, "crib_force")[k] +
                        column(one, "end_force")[k] + column(one, "other_force")[k])
                      .epsilon(1e-9));
        CHECK(column(one, "displacement").back() == about(bed.displacement).epsilon(0.05));
        CHECK(column(one, "force").back() > 0);
        CHECK(column(one, "base_force").back() > 0);

        PushedTie two(bed, {}, made, 2, folder.path());
        two.go();
        CHECK(two.fingerprint() == one.fingerprint());
        PushedTie resumed(bed, {}, made, 3, folder.path());
        resumed.run.resume(folder / "middle.ckpt.h5");
        CHECK(resumed.curve.rows() == 11);
        resumed.go();
        CHECK(resumed.fingerprint() == one.fingerprint());

        PushedTie bare(bed, {.with_shoulder = false}, made, 1, folder.path());
        bare.go();
        CHECK(std::abs(column(bare, "end_force").back()) <
              1e-9 + 0.5 * std::abs(column(one, "force").back()));
        CHECK(column(bare, "support").front() == about(9.81 * bed.tie_mass).epsilon(0.05));
    }

    TEST_CASE("settings of a tie that do not fit together are refused by name") {
        TieBed close = small_bed();
        close.spacing = 0.3;
        CHECK(refusal_of([&] { check_tie_bed(close); }).find("--spacing") == 0);
        TieBed coarse = small_bed();
        coarse.rocks.scale = 2;
        CHECK(refusal_of([&] { (void)make_tie_bed(coarse, 1, 1, false); }).find("--spacing") == 0);
        TieBed few = small_bed();
        few.interval = 1e-3;
        CHECK(refusal_of([&] { check_tie_bed(few); }).find("--interval") == 0);
    }
}
