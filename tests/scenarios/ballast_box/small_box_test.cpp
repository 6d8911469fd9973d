// A small ballast box from the first rock to its last load cycle.
#include "engine/errors.hpp"
#include "engine/resume.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/cycles.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/quiet_run.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

using namespace bris;
using namespace bris::testing;

namespace {

BallastBox small_box(const char* name) {
    BallastBox box;
    box.run = name;
    box.rock_scale = 2;
    box.width = 0.26;
    box.porosity = 0.42;
    box.cycles = 3;
    box.steps_per_cycle = 10'000;
    box.fouling.settings.voxel = 0.02;
    return box;
}

/// A run whose phases are those of the making of the bed, or those after it.
class SmallRun {
public:
    SmallRun(const BallastBox& box, unsigned threads, const std::filesystem::path& out)
        : simulation(
              start(make_box_world(box, 1), {.law = LawName::linear_viscous, .threads = threads})),
          test(simulation, box, 1), common(bris::testing::quiet_run("ballast_box", out)),
          run(simulation, common, "ballast_box"), samples("box") {
        run.keep(samples);
    }
    const World& world() const { return simulation.world(); }
    void make_bed() { run.go(test.making_of_bed()); }
    /// Seats the ties and applies the cycles.
    void load(const char* checkpoint_after_first = nullptr) {
        bool saved = checkpoint_after_first == nullptr;
        std::vector<Phase> phases = test.seating();
        phases.push_back(test.loading(run, samples, [&, this] {
            if (!saved) run.save_as(checkpoint_after_first);
            saved = true;
        }));
        run.go(phases);
    }
    std::uint64_t fingerprint() const { return bris::fingerprint(simulation.snapshot()); }

    Simulation simulation;
    BoxTestRun test;
    Common common;
    Run run;
    SeriesOf<CycleSample> samples;
};

} // namespace

TEST_SUITE("ballast_box") {
    TEST_CASE("a small box is compacted, comes to rest, carries its load to the subgrade and "
              "settles, with the same bits for any threads and after resuming") {
        const TemporaryDirectory folder;
        const BallastBox clean = small_box("I.2");
        SmallRun bed(clean, 1, folder.path());
        bed.make_bed();
        const Archive made = bed.simulation.snapshot();
        const auto& lifts = bed.world().resource<BoxState>().porosity;
        for (const double porosity : lifts) {
            CHECK(porosity > 0.36);
            CHECK(porosity < 0.43); // the plate may loosen a lift by 0.01 when it is taken away
        }

        SmallRun one(clean, 1, folder.path());
        one.simulation.restore(made);
        one.load("middle");
        const auto& state = one.world().resource<BoxState>();
        CHECK(state.seat_ratio <= clean.rest);
        CHECK(state.seat_support == about(1).epsilon(0.01));
        // at the peak load the subgrade carries it and the weight; guides carry the remainder
        const auto &load = one.samples[&CycleSample::load_1],
                   &base = one.samples[&CycleSample::subgrade_force],
                   &tie = one.samples[&CycleSample::tie_support];
        const auto peak = static_cast<std::size_t>(std::ranges::max_element(load) - load.begin());
        const double weight = compute_quantities(one.world()).weight.norm();
        CHECK(load[peak] == about(290e3 * box_sizes(clean).share).epsilon(1e-3));
        CHECK(tie[peak] == about(load[peak]).epsilon(0.05));
        CHECK(base[peak] > 0.85 * load[peak]);
        CHECK(base[peak] < 1.05 * (load[peak] + weight));
        const auto cycles = cycle_responses(one.samples, 1);
        REQUIRE(cycles.size() == 3);
        CHECK(cycles[0].settlement > 0);
        CHECK(cycles[2].settlement > cycles[0].settlement);
        CHECK(cycles[2].settlement - cycles[1].settlement < cycles[0].settlement);
        for (const CycleResponse& c : cycles) {
            CHECK(c.loop_area > 0);
            // the subgrade gives about half; 0.05 for the weight of the ballast and for dashpots
            CHECK(c.of_subgrade > 0.4 * c.resilient);
            CHECK(c.of_contacts > 0.02 * c.resilient);
            CHECK(c.of_subgrade + c.of_contacts < 1.05 * c.resilient);
        }

        SmallRun two(clean, 2, folder.path());
        two.simulation.restore(made);
        two.load();
        CHECK(two.fingerprint() == one.fingerprint());

        SmallRun resumed(clean, 1, folder.path());
        resumed.run.resume(folder / "middle.ckpt.h5");
        resumed.load();
        CHECK(resumed.fingerprint() == one.fingerprint());

        // on clean ballast water acts on the stones alone, of which limestone loses 11 % of its
        // friction: the run has no fields
        SmallRun wet(small_box("I.3"), 1, folder.path());
        wet.simulation.restore(made);
        wet.load();
        CHECK_FALSE(wet.world().has_resource<Fouling>());
        const auto friction = [](const World& world) {
            const std::uint32_t rock = world.resource<BoxBodies>().rock;
            return world.resource<Materials>().list[rock].friction;
        };
        CHECK(friction(wet.world()) == about(0.89 * friction(one.world())));
        CHECK(wet.fingerprint() != one.fingerprint());

        // fines and water come to a track in use, which then loses its shoulder
        BallastBox filled = small_box("II.4");
        filled.fines = "filled";
        SmallRun used(filled, 1, folder.path());
        used.simulation.restore(made);
        std::vector<Phase> phases{used.test.seat()};
        double before = 0;
        for (Phase& phase : used.test.changes_in_use()) phases.push_back(std::move(phase));
        REQUIRE(phases.size() == 3);
        phases[1].begin = [&, begin = phases[1].begin](Simulation& s) {
            before = value_of<Position>(s, s.world().resource<BoxBodies>().ties.front()).z();
            begin(s);
        };
        used.run.go(phases);
        CHECK(measure_fouling(used.world(), present_fouling(used.world())).saturation > 80);
        CHECK(used.world().resource<BoxState>().seat_support == about(1).epsilon(0.01));
        const auto& bodies = used.world().resource<BoxBodies>();
        CHECK(value_of<Position>(used.simulation, bodies.ties.front()).z() < before);
        CHECK(value_of<Position>(used.simulation, bodies.bladder).y() >
              value_of<Position>(one.simulation, bodies.bladder).y() + 0.2);

        const auto fouled_run = [&](const char* name) {
            auto run = std::make_unique<SmallRun>(small_box(name), 1, folder.path());
            run->simulation.restore(made);
            run->load();
            return run;
        };
        const auto dry = fouled_run("II.2"), fouled_wet = fouled_run("II.3");
        for (const auto* run : {dry.get(), fouled_wet.get()}) {
            const Fouling present = present_fouling(run->world());
            const FoulingMeasures m = measure_fouling(run->world(), present);
            CHECK(m.p4 == about(17).epsilon(1e-6));
            CHECK(m.fouling_index == about(20).epsilon(1e-6));
            CHECK(present.fines_beyond == 0);
            CHECK_FALSE(run->world().resource<Materials>().weakened().empty());
        }
        CHECK(measure_fouling(dry->world(), present_fouling(dry->world())).saturation == 0);
        const auto least_friction = [](const World& world) {
            double least = 1;
            for (const WeakenedPair& pair : world.resource<Materials>().weakened())
                least = std::min(least, pair.friction);
            return least;
        };
        CHECK(friction(fouled_wet->world()) == about(0.89 * friction(dry->world())));
        CHECK(least_friction(dry->world()) < 0.9);
        CHECK(least_friction(fouled_wet->world()) < least_friction(dry->world()) - 0.02);
        CHECK(dry->samples[&CycleSample::deflection_1] != one.samples[&CycleSample::deflection_1]);
        CHECK(fouled_wet->samples[&CycleSample::deflection_1] !=
              dry->samples[&CycleSample::deflection_1]);
    }

    TEST_CASE("a bed that is mixed with fines has them in each lift while it is compacted, and its "
              "whole mass of them in the end") {
        const TemporaryDirectory folder;
        BallastBox box = small_box("II.2");
        box.fouling.kind = "clay";
        SmallRun mixed(box, 1, folder.path());
        std::vector<Phase> phases = mixed.test.making_of_bed();
        std::vector<double> fines; // %, of what lies there as each lift begins to be compacted
        for (const std::size_t compaction : std::initializer_list<std::size_t>{1, 3, 6})
            phases[compaction].begin = [&, begin = phases[compaction].begin](Simulation& s) {
                begin(s);
                fines.push_back(measure_fouling(s.world(), present_fouling(s.world())).p4);
            };
        mixed.run.go(phases);
        REQUIRE(fines.size() == 3);
        // rocks have more mass while the bed is made
        for (const double p4 : fines) CHECK(p4 == about(17).epsilon(0.1));
        // friction alone is weaker meanwhile: by 1 - 0.81 g, with g above 0.3
        const auto least_of = [](const World& world, auto member) {
            double least = 1;
            for (const WeakenedPair& pair : world.resource<Materials>().weakened())
                least = std::min(least, pair.*member);
            return least;
        };
        CHECK(least_of(mixed.world(), &WeakenedPair::stiffness) == 1);
        CHECK(least_of(mixed.world(), &WeakenedPair::friction) < 0.76);
        for (const double porosity : mixed.world().resource<BoxState>().porosity)
            CHECK(porosity < 0.43);
        SmallRun loaded(box, 1, folder.path());
        add_fields(loaded.simulation, box);
        loaded.simulation.restore(mixed.simulation.snapshot());
        loaded.load();
        const FoulingMeasures m = measure_fouling(loaded.world(), present_fouling(loaded.world()));
        CHECK(m.p4 == about(17).epsilon(1e-6));
        CHECK(cycle_responses(loaded.samples, 1).size() == 3);
        CHECK(least_of(loaded.world(), &WeakenedPair::stiffness) < 0.65); // films: 1 + 2 g
    }
}
