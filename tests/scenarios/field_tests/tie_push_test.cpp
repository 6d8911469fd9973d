// Push of a short tie through a small bed.
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/run.hpp"
#include "scenarios/field_tests/tie_bed.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

TieBed small_bed() {
    TieBed bed;
    bed.tie_length = 0.3;
    bed.tie_mass = 100;
    bed.base = 0.15;
    bed.shoulder = 0.1;
    bed.rocks.scale = 1.2;
    bed.porosity = 0.45;
    bed.displacement = 2e-3;
    bed.speed = 0.05;
    bed.interval = 1e-4;
    return bed;
}

} // namespace

TEST_SUITE("tie_push") {
    TEST_CASE(
        "a short tie is carried by its bed, which resists its push at base, crib and end, less "
        "without a shoulder, with the same bits for any threads") {
        const TemporaryDirectory folder;
        Common common;
        common.scenario = "tie_push";
        common.out = folder.path();
        common.quiet = true;
        const TieBed bed = small_bed();
        Simulation making = make_tie_bed(bed, 1, 2);
        Run(making, common, "specimen").go(make_bed_phases());
        const Archive made = making.snapshot();
        CHECK(std::as_const(making).world().resource<RockBedState>().porosity ==
              about(bed.porosity).epsilon(bed.porosity_tolerance / bed.porosity));

        struct Pushed {
            SeriesOf<PushSample> curve;
            std::uint64_t fingerprint;
        };
        const auto push = [&](bool with_shoulder, unsigned threads) {
            Simulation simulation = make_tie_bed(bed, 1, threads);
            simulation.restore(made);
            SeriesOf<PushSample> curve("push");
            Run(simulation, common, "tie_push")
                .go(push_phases(bed, {.with_shoulder = with_shoulder}, curve, [](const World&) {}));
            return Pushed{curve, fingerprint(simulation.snapshot())};
        };
        const Pushed with = push(true, 1), without = push(false, 1);
        const auto mean_of_last = [](const SeriesOf<PushSample>& curve,
                                     double PushSample::*number) {
            const auto& values = curve[number];
            double sum = 0;
            for (std::size_t k = values.size() - 10; k < values.size(); ++k) sum += values[k] / 10;
            return sum;
        };
        for (const Pushed* run : {&with, &without}) {
            CHECK(run->curve[&PushSample::support].front() ==
                  about(9.81 * bed.tie_mass).epsilon(0.02)); // at rest
            CHECK(run->curve[&PushSample::displacement].back() >= bed.displacement);
            const double force = mean_of_last(run->curve, &PushSample::force);
            CHECK(force > 0.3 * 9.81 * bed.tie_mass);
            double parts = 0;
            for (const auto part : {&PushSample::base_force, &PushSample::crib_force,
                                    &PushSample::end_force, &PushSample::other_force})
                parts += mean_of_last(run->curve, part);
            CHECK(parts == about(force).epsilon(1e-9));
        }
        CHECK(mean_of_last(without.curve, &PushSample::force) <
              mean_of_last(with.curve, &PushSample::force));
        CHECK(mean_of_last(with.curve, &PushSample::end_force) >
              mean_of_last(without.curve, &PushSample::end_force));
        CHECK(push(true, 2).fingerprint == with.fingerprint);
    }

    TEST_CASE("settings of a tie that do not fit together are refused by name") {
        TieBed close = small_bed();
        close.spacing = 0.3;
        CHECK(refusal_of([&] { check_tie_bed(close); }).find("--spacing") == 0);
        TieBed coarse = small_bed();
        coarse.rocks.scale = 2;
        CHECK(refusal_of([&] { (void)make_tie_bed(coarse, 1, 1); }).find("--spacing") == 0);
        TieBed few = small_bed();
        few.interval = 1e-3;
        CHECK(refusal_of([&] { check_tie_bed(few); }).find("--interval") == 0);
    }
}
