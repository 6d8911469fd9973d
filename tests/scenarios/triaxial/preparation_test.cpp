#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/make_specimen.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "systems/output/balance.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/small_specimen.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;
using testing::short_test, testing::small_scene;

namespace {

TriaxialSettings at_porosity(double porosity, double tolerance = 0.01) {
    TriaxialSettings settings = short_test();
    settings.porosity = porosity;
    settings.porosity_tolerance = tolerance;
    settings.final_axial_strain = settings.stage_strain;
    return settings;
}

/// Touching pairs per rock of a specimen as it was prepared, under the platen. The limit of
/// overlaps is higher from when rocks are vibrated or tapped until they are sheared, and only then.
double contacts_of(const TriaxialSettings& settings) {
    Simulation simulation = make_simulation(small_scene(), 1);
    TriaxialTest test(simulation, settings);
    double contacts = 0;
    while (test.state().phase < TriaxialPhase::consolidate) {
        const TriaxialPhase phase = test.state().phase;
        CHECK((simulation.world().resource<Limits>().impact_allowance > 1) ==
              (phase == TriaxialPhase::vibrate || phase == TriaxialPhase::tap));
        const Balance balance = compute_balance(simulation.world());
        contacts = static_cast<double>(balance.contacts) / static_cast<double>(balance.free_bodies);
        REQUIRE(test.advance());
    }
    while (test.state().phase < TriaxialPhase::shear) REQUIRE(test.advance());
    CHECK(simulation.world().resource<Limits>().impact_allowance == 1);
    return contacts;
}

} // namespace

TEST_SUITE("triaxial/preparation") {
    TEST_CASE("a specimen has the porosity asked for when it is sheared, loose or dense, and its "
              "sensor rocks stand where they were given") {
        for (const double porosity : {0.36, 0.40, 0.42}) {
            const TemporaryDirectory folder;
            Common common;
            common.out = folder.path();
            common.threads = 1;
            const TriaxialSettings settings = at_porosity(porosity, 0.005);
            const MadeSpecimen made =
                make_specimen(small_scene(), settings, common, [](const PhaseProgress&) {});
            Simulation simulation = make_simulation(small_scene(), 1);
            TriaxialTest test(simulation, settings);
            simulation.restore(made.state);
            while (test.advance()) {
            }
            CAPTURE(porosity);
            MESSAGE("trial consolidations: ", test.state().trials);
            // tried with a larger unbalanced force ratio than that of the test
            CHECK(test.state().core_porosity == about(porosity).epsilon(0.0052 / porosity));
            CHECK(test.state().accepted);
            CHECK(test.state().poured_porosity > porosity);
            // a sensor rock that gave way comes back while friction is reduced
            CHECK(test.state().drift < (porosity > 0.41 ? 0.02 : 0.004));
        }
    }

    TEST_CASE(
        "a specimen that a trial consolidation found too dense is poured anew and aims higher, "
        "with its sensor rocks held where they were given") {
        Simulation simulation = make_simulation(small_scene(), 1);
        const TriaxialSettings settings = at_porosity(0.40);
        TriaxialTest test(simulation, settings);
        const auto prepare = [&] {
            double moved = 0;
            while (test.state().phase < TriaxialPhase::consolidate) {
                REQUIRE(test.advance());
                // the lid stands still while the rocks grow
                if (test.state().phase == TriaxialPhase::fill && test.state().phase_steps > 0)
                    for (const SensorDrift& d : sensor_drift(simulation.world()))
                        moved = std::max(moved, (d.now - d.given).norm());
            }
            return moved;
        };
        CHECK(prepare() < 1e-12);
        CHECK(test.state().prepared_porosity == about(0.40).epsilon(0.01 / 0.40));
        test.judge(0.385);
        CHECK_FALSE(test.state().accepted);
        CHECK(test.state().aim == about(0.415).epsilon(1e-12));
        CHECK(test.state().phase == TriaxialPhase::fill);
        const World& world = simulation.world();
        CHECK_FALSE(world.resource<Membrane>().active);
        for (const EntityId id : world.resource<Specimen>().smart_rocks)
            CHECK(world.column<Bodies, MotionOf>()[row_of_body(world, id)] ==
                  static_cast<std::uint32_t>(Motion::prescribed));
        CHECK(prepare() < 1e-12);
        CHECK(test.state().prepared_porosity == about(0.415).epsilon(0.01 / 0.415));
        test.judge(0.392);
        CHECK(test.state().accepted);
        CHECK(test.state().phase == TriaxialPhase::consolidate);
        CHECK(test.state().trials == 2);
    }

    TEST_CASE(
        "a porosity that no trial consolidation meets ends the preparation with the number of "
        "trials") {
        Simulation simulation = make_simulation(small_scene(), 1);
        TriaxialTest test(simulation, at_porosity(0.40));
        while (test.state().phase < TriaxialPhase::consolidate) REQUIRE(test.advance());
        CHECK_THROWS_WITH_AS(
            [&] {
                for (int k = 0; k < 20; ++k) test.judge(k % 2 == 0 ? 0.42 : 0.38);
            }(),
            doctest::Contains("in the last of 8 trial consolidations"), SimulationError);
    }

    TEST_CASE("taps replace the contacts that formed without friction by fewer ones") {
        TriaxialSettings settings = at_porosity(0.38);
        settings.taps = 0;
        const double untapped = contacts_of(settings);
        settings.taps = 4;
        const double tapped = contacts_of(settings);
        MESSAGE("contacts per rock: ", untapped, " without taps, ", tapped, " with");
        CHECK(tapped < 0.75 * untapped);
    }

    TEST_CASE("a porosity above that of poured rocks is refused with the one that can be reached") {
        Simulation simulation = make_simulation(small_scene(), 1);
        TriaxialTest test(simulation, at_porosity(0.58));
        CHECK_THROWS_WITH_AS(
            [&] {
                while (test.advance()) {
                }
            }(),
            doctest::Contains("denser as poured, 0."), SimulationError);
    }

    TEST_CASE("the pressure of the platen during preparation follows the contact stiffness") {
        const auto pressure_of = [](double stiffness, double given) {
            Simulation simulation = make_simulation(small_scene({.clump_stiffness = stiffness}), 1);
            TriaxialSettings settings = at_porosity(0.40);
            settings.preparation_pressure = given;
            TriaxialTest test(simulation, settings);
            while (test.state().phase < TriaxialPhase::compress) REQUIRE(test.advance());
            return simulation.world().resource<Platen>().target_pressure;
        };
        const double usual = pressure_of(0.63e8, 0);
        CHECK(pressure_of(0.63e7, 0) == about(usual / 10).epsilon(1e-12));
        CHECK(pressure_of(0.63e7, 2e5) == 2e5);
        // k_n / 3000 of two springs in series, over a size between the sieves of the grading
        CHECK(0.63e8 / 2 / 3000 / usual > 0.019);
        CHECK(0.63e8 / 2 / 3000 / usual < 0.0508);
    }

    TEST_CASE("a mould too narrow for its rocks is refused with the number of rocks that works") {
        Triaxial t;
        t.bodies = 100;
        CHECK_THROWS_WITH_AS(make_scene(t, 1), doctest::Contains("needs 210 rocks"), InputError);
        t.bodies = 210;
        CHECK_NOTHROW(make_scene(t, 1));
        t.grading = "arema_57";
        CHECK_THROWS_WITH_AS(make_scene(t, 1), doctest::Contains("found 1.4"), InputError);
        t.least_diameter = 1;
        CHECK_NOTHROW(make_scene(t, 1));
    }

    TEST_CASE("load is carried if the rocks that touch any have a contact each, however many "
              "rocks float") {
        CHECK(carries_load({.contacts = 40, .free_bodies = 100, .idle_bodies = 70}));
        CHECK_FALSE(carries_load({.contacts = 20, .free_bodies = 100, .idle_bodies = 70}));
        CHECK_FALSE(carries_load({.contacts = 0, .free_bodies = 100, .idle_bodies = 100}));
    }

    TEST_CASE("platens keep a friction coefficient of their own when that of the rocks changes") {
        Simulation simulation = make_simulation(small_scene({.platen_friction = 0.1}), 1);
        set_friction(simulation.world(), 0.5);
        const auto& materials = simulation.world().resource<Materials>();
        const auto& specimen = simulation.world().resource<Specimen>();
        CHECK(materials.list[specimen.platen_material].friction == 0.1);
        CHECK(materials.list[specimen.rock_material].friction == 0.5);
    }
}
