#include "systems/broadphase/lists.hpp"
#include "systems/build/clump_library.hpp"
#include "systems/contact/ledger.hpp"
#include "systems/procedure/triaxial.hpp"
#include "systems/procedure/triaxial_results.hpp"
#include "systems/steps.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

constexpr double pressure = 110e3;

// 160 rocks: too few to say anything of ballast, enough for every mechanism of the test
Simulation small_test(unsigned threads, ListSettings lists = {}, ScheduleSettings schedule = {}) {
    const std::filesystem::path assets = BRIS_ASSETS;
    auto clumps = read_clumps(assets / "clumps");
    std::erase_if(clumps, [](const Clump& c) { return c.name == "cube"; });
    const auto sample = sample_rocks(read_grading(assets / "gradings" / "arema_4.csv"), clumps, 150, 3);
    SpecimenSettings s;
    s.seed = 3;
    const Clump smart = scaled(clumps[0], 0.02);
    s.radius = radius_for(sample.solid_volume + 10 * smart.volume, 0.42, s.sectors);
    s.height = 4 * s.radius;
    World world = make_triaxial_world(s, clumps, smart, sample.rocks, smart_rock_poses({s.radius, s.height, smart.bounding_radius}, s.seed, 10));
    add_lists(world, LawName::linear, lists);
    add_ledger(world);
    world.add_resource<TriaxialState>();
    Simulation simulation(std::move(world), steps(LawName::linear, true), threads, schedule);
    simulation.on_restore(forget_lists);
    return simulation;
}

TriaxialSettings short_test() {
    TriaxialSettings settings;
    settings.confining_pressure = pressure;
    settings.porosity = 0.38; // soon reached: this is not about density
    settings.porosity_tolerance = 0.04;
    settings.final_axial_strain = 0.002;
    settings.tolerance = 3e-4;
    return settings;
}

} // namespace

TEST_SUITE("procedure/triaxial") {
    TEST_CASE("a triaxial test keeps its pressure, its stress balance and its energy balance") {
        Simulation simulation = small_test(1);
        TriaxialTest test(simulation, short_test());
        while (test.advance()) {}
        const auto& points = test.state().points;
        REQUIRE(points.size() == 21);
        const TriaxialProperties p = properties_of(points, pressure);
        CHECK(p.worst_ring_error <= 0.01);        // the criterion itself
        CHECK(p.worst_stress_mismatch <= 0.01);   // a few tens of the unbalanced ratio: branch vectors are long
        MESSAGE("energy mismatch ", p.energy_mismatch, ", stress mismatch ", p.worst_stress_mismatch);
        CHECK(p.energy_mismatch <= 0.01);
        CHECK(p.peak_q > 0.1 * pressure); // at 0.2 % of strain a loose and tiny specimen is far from its peak
        CHECK(points.back().axial_strain == doctest::Approx(0.002).epsilon(1e-9));
        for (std::size_t k = 1; k < points.size(); ++k) CHECK(points[k].unbalanced <= 1e-3);
    }

    TEST_CASE("a test restored from any phase ends with the same bits, whatever runs the steps") {
        Simulation simulation = small_test(1);
        TriaxialTest test(simulation, short_test());
        // at the start of a lift, of compaction, of consolidation and of a stage, and inside a stage
        std::vector<Archive> saved;
        const auto reached = [&] {
            const TriaxialState& s = test.state();
            switch (saved.size()) {
            case 0: return s.lift == 2;
            case 1: return s.phase == TriaxialPhase::compact;
            case 2: return s.phase == TriaxialPhase::consolidate;
            case 3: return s.phase == TriaxialPhase::shear && s.stage == 1 && s.phase_steps == 0;
            case 4: return s.phase == TriaxialPhase::shear && s.stage == 1 && s.phase_steps > 0;
            default: return false;
            }
        };
        while (test.state().stage < 2) {
            REQUIRE(test.advance());
            if (reached()) saved.push_back(simulation.snapshot());
        }
        REQUIRE(saved.size() == 5);
        const auto whole = fingerprint(simulation.snapshot());
        const auto end_from = [&](const Archive& state, Simulation other) {
            other.restore(state);
            TriaxialTest rest(other, short_test());
            while (rest.state().stage < 2) REQUIRE(rest.advance());
            return fingerprint(other.snapshot());
        };
        for (std::size_t k = 0; k < saved.size(); ++k) {
            CAPTURE(k);
            CHECK(end_from(saved[k], small_test(2)) == whole);
        }
        // and whatever runs the steps: threads, graph, order, sorting, skins
        const Archive& stage = saved[3];
        for (const unsigned threads : {1u, 2u, 3u, 7u}) CHECK(end_from(stage, small_test(threads, {}, {.grain = 16})) == whole);
        CHECK(end_from(stage, small_test(2, {}, {.serial = true})) == whole);
        CHECK(end_from(stage, small_test(2, {}, {.last_order = true, .grain = 16})) == whole);
        CHECK(end_from(stage, small_test(1, {.sort_every = 0})) == whole);
        CHECK(end_from(stage, small_test(1, {.sort_every = 1})) == whole);
        CHECK(end_from(stage, small_test(1, {.outer_skin = 0.002, .inner_skin = 0.0002, .tune = false})) == whole);
        CHECK(end_from(stage, small_test(1, {.outer_skin = 0.005, .inner_skin = 0.001, .tune = false})) == whole);
    }
}
