#include "components/load_ramp.hpp"
#include "components/platen.hpp"
#include "engine/errors.hpp"
#include "scenarios/triaxial/cyclic_results.hpp"
#include "scenarios/triaxial/load_cycles.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "systems/servo/membrane.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/small_specimen.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using testing::prepared, testing::pressure, testing::short_test, testing::small_scene;

namespace {

const Archive& small_specimen() {
    static const Archive specimen = prepared(small_scene());
    return specimen;
}

TriaxialSettings cyclic(const LoadCycles& cycles) {
    TriaxialSettings settings = short_test();
    settings.cycles = cycles;
    return settings;
}

/// A cyclic test on the small specimen.
struct CyclicTest {
    TriaxialScene scene;
    Simulation simulation;
    TriaxialTest test;
    CyclicTest(const LoadCycles& cycles, unsigned threads = 1, const SpecimenSettings& rocks = {},
               const Archive* from = nullptr)
        : scene(small_scene(rocks)), simulation(make_simulation(scene, threads)),
          test(simulation, cyclic(cycles)) {
        if (from != nullptr)
            simulation.restore(*from);
        else
            restore_specimen(simulation, scene, small_specimen());
    }
    const CyclicState& run() {
        while (test.advance()) {
        }
        return test.state().cyclic;
    }
    double energy_error() const {
        return properties_of(test.state().curves, pressure).relative_energy_error;
    }
};

/// A loop of q and a strain that lags behind by a small angle (rad), with a given range of both and
/// a permanent strain.
SeriesOf<LoadPoint> lagging_loop(double range_q, double range, double lag, double permanent) {
    SeriesOf<LoadPoint> points("loop");
    constexpr int all = 320;
    for (int k = 0; k <= all; ++k) {
        const double part = static_cast<double>(k) / all, angle = 2 * pi * part;
        const double strain = 0.02 + 0.5 * range * (1 - std::cos(angle - lag)) + permanent * part;
        points.add({.cycle = 6 + part,
                    .time = 0.2 * (6 + part),
                    .q = 20e3 + 0.5 * range_q * (1 - std::cos(angle)),
                    .axial_strain = strain,
                    .volumetric_strain = 0.4 * strain,
                    .worst_ring_error = 0.01 * part});
    }
    return points;
}

} // namespace

TEST_SUITE("triaxial/load_cycles") {
    TEST_CASE("the load goes through its turning points along half a cosine and stays there") {
        LoadRamp ramp{.from = 10e3, .to = 230e3, .start = 2, .duration = 0.1};
        CHECK(ramp.at(0) == 10e3);
        CHECK(ramp.at(2) == 10e3);
        CHECK(ramp.at(2.05) == about(120e3).epsilon(1e-12));
        CHECK(ramp.at(2.025) == about(120e3 - 110e3 * std::cos(pi / 4)).epsilon(1e-12));
        CHECK(ramp.at(2.1) == 230e3);
        CHECK(ramp.at(9) == 230e3);
        CHECK(ramp.force(9, 0.02) == about(4600).epsilon(1e-12));
        ramp.area = 0.01;
        CHECK(ramp.force(9, 0.02) == about(2300).epsilon(1e-12));
    }

    TEST_CASE("the first half cycle begins at the isotropic state, and the largest load grows over "
              "its ramp") {
        const LoadCycles cycles{.count = 9,
                                .least_q = 10e3,
                                .largest_q = 110e3,
                                .ramp_cycles = 4,
                                .rest_every = 3,
                                .rest = 5};
        const double levels[] = {0, 35e3, 10e3, 60e3, 10e3, 85e3, 10e3, 110e3, 10e3, 110e3, 10e3};
        for (std::uint64_t k = 0; k < std::size(levels); ++k)
            CHECK(std::abs(cycles.level_after(k) - levels[k]) < 1e-9);
        for (const std::uint64_t k : {0UL, 2UL, 4UL, 5UL, 7UL, 8UL, 10UL})
            CHECK(cycles.rest_after(k) == 0);
        for (const std::uint64_t k : {6UL, 12UL}) CHECK(cycles.rest_after(k) == 5);
    }

    TEST_CASE("modulus, Poisson ratio and damping ratio of a viscoelastic loop are those of its "
              "closed form") {
        constexpr double q = 220e3, strain = 2e-3, lag = 0.05;
        const CyclicResponse r = response_of(lagging_loop(q, strain, lag, 0), 2e-4);
        // from the largest strain, at the angle pi + lag, to the end of the cycle
        const double recovered = 0.5 * strain * (1 + std::cos(lag)),
                     fall = 0.5 * q * (1 + std::cos(lag));
        CHECK(r.resilient_modulus == about(fall / recovered).epsilon(1e-3));
        CHECK(r.poisson_ratio == about(0.3).epsilon(1e-9));
        CHECK(r.damping_ratio ==
              about(2 * (pi * q * strain * std::sin(lag) / 4) / (pi * fall * recovered))
                  .epsilon(1e-3));
        CHECK(r.damping_ratio == about(0.5 * std::sin(lag)).epsilon(5e-3));
        CHECK(r.largest_q == about(240e3).epsilon(1e-12));
        CHECK(r.worst_ring_error == about(0.01).epsilon(1e-12));
        CHECK(r.cycle == about(7).epsilon(1e-12));
        const CyclicResponse with = response_of(lagging_loop(q, strain, 0, 1e-3), 2e-4);
        CHECK(with.axial_strain == about(0.021).epsilon(1e-12));
        CHECK(with.volumetric_strain == about(0.4 * 0.021).epsilon(1e-12));
    }

    TEST_CASE("growth by decade is that of the cycles, and unknown before the test has come so "
              "far") {
        CyclicState state;
        for (int n = 1; n <= 200; ++n) {
            CyclicResponse response{};
            response.cycle = n;
            response.axial_strain = 0.01 + 0.02 * std::log10(n);
            state.responses.add(response);
        }
        const auto values = named_values_of(state);
        const auto value = [&](const std::string& key) {
            const auto found = std::ranges::find(values, key, &NamedValue::key);
            REQUIRE(found != values.end());
            return std::get<double>(found->value);
        };
        CHECK(values.front().key == "load_cycles");
        CHECK(std::get<std::uint64_t>(values.front().value) == 200);
        CHECK(value("axial_strain_after_100_cycles") == about(0.05).epsilon(1e-12));
        CHECK(value("axial_strain_in_last_decade") == about(0.02).epsilon(1e-9));
        CHECK(value("axial_strain_in_decade_before") == about(0.02).epsilon(1e-9));
        CHECK(is_shown_cycle(1));
        CHECK(is_shown_cycle(500));
        CHECK(!is_shown_cycle(0));
        CHECK(!is_shown_cycle(30));
    }

    TEST_CASE("a platen with a mass of its own oscillates on a spring as that mass") {
        constexpr double mass = 3, spring = 2e6, dt = 1e-6;
        double stiffness = 1e8; // the mass that the step requires is far smaller
        ServoMotion servo{stiffness, 0, 1, dt, mass};
        double speed = 0, position = 1e-4, last = position;
        int turns = 0;
        double first = 0, end = 0;
        for (int k = 0; k < 200'000; ++k) {
            speed = servo.next(speed, -spring * position, 0);
            last = position;
            position += speed * dt;
            if (last > 0 && position <= 0) {
                end = k * dt;
                if (turns++ == 0) first = end;
            }
        }
        CHECK(turns > 20);
        CHECK((end - first) / (turns - 1) ==
              about(2 * pi * std::sqrt(mass / spring)).epsilon(1e-3));
    }

    TEST_CASE("quasi-static cycles meet their loads at rest, recover most of a second cycle, and "
              "close their energy budget") {
        for (const std::string area : {"nominal", "present"}) {
            CyclicTest test({.count = 3,
                             .least_q = 10e3,
                             .largest_q = 60e3,
                             .frequency = 0,
                             .half_steps = 600,
                             .area = area});
            const CyclicState& s = test.run();
            REQUIRE(s.responses.rows() == 3);
            const auto& curves = test.test.state().curves;
            CHECK(curves.size() == 4); // start and cycles 1, 2 and 3
            for (std::size_t n = 0; n < 3; ++n) {
                const CyclicResponse r = s.responses.at(n);
                CHECK(r.cycle == about(1 + static_cast<double>(n)).epsilon(1e-12));
                CHECK(r.largest_q == about(60e3).epsilon(0.05));
                CHECK(s.loops.rows() == 3 * 33);
                CHECK(r.unbalanced_ratio <= 3e-4);
                CHECK(r.resilient_modulus > 1e6);
                CHECK(r.damping_ratio > 0);
            }
            const CyclicResponse first = s.responses.at(0), second = s.responses.at(1);
            CHECK(first.axial_strain > 0);
            CHECK(second.axial_strain - first.axial_strain < first.axial_strain);
            MESSAGE("energy error ", test.energy_error(), ", permanent strain ", first.axial_strain,
                    " ", second.axial_strain);
            CHECK(test.energy_error() <= 0.01);
        }
    }

    TEST_CASE("cycles at a frequency last as long as it says, with the true masses, and the load "
              "arrives in full") {
        CyclicTest test({.count = 2, .least_q = 10e3, .largest_q = 60e3, .frequency = 40});
        const CyclicState& s = test.run();
        REQUIRE(s.responses.rows() == 2);
        const double dt = std::as_const(test.simulation).world().resource<Clock>().dt;
        CHECK(s.responses.at(1).time == about(0.05).epsilon(2 * dt / 0.05));
        CHECK(s.responses.at(1).largest_q == about(60e3).epsilon(0.1));
        const World& world = std::as_const(test.simulation).world();
        const auto mass = world.column<Bodies, Mass>();
        const auto inertial = world.column<Bodies, InertialMass>();
        const auto motion = world.column<Bodies, MotionOf>();
        std::size_t compared = 0;
        for (std::size_t k = 0; k < mass.size(); ++k)
            if (motion[k] == static_cast<std::uint32_t>(Motion::free)) {
                CHECK(inertial[k] == mass[k]);
                ++compared;
            }
        CHECK(compared == 160);
        MESSAGE("energy error ", test.energy_error());
        CHECK(test.energy_error() <= 0.01);
    }

    TEST_CASE("a slow frequency gives what quasi-static cycles give") {
        const auto permanent = [](double frequency) {
            CyclicTest test({.count = 1,
                             .least_q = 10e3,
                             .largest_q = 40e3,
                             .frequency = frequency,
                             .half_steps = 4000});
            return test.run().responses.at(0);
        };
        const CyclicResponse slow = permanent(10), still = permanent(0);
        MESSAGE(slow.largest_axial_strain, " and ", still.largest_axial_strain);
        CHECK(slow.largest_axial_strain == about(still.largest_axial_strain).epsilon(0.05));
        CHECK(slow.resilient_modulus == about(still.resilient_modulus).epsilon(0.05));
    }

    TEST_CASE("a specimen can be extended") {
        CyclicTest test(
            {.count = 1, .least_q = -40e3, .largest_q = 20e3, .frequency = 0, .half_steps = 600});
        const CyclicState& s = test.run();
        CHECK(s.responses.at(0).least_q == about(-40e3).epsilon(0.05));
        CHECK(s.responses.at(0).axial_strain < s.responses.at(0).largest_axial_strain);
    }

    TEST_CASE("a specimen that cannot carry the load fails in its cycle, at the largest strain") {
        CyclicTest test({.count = 5, .largest_q = 1500e3, .frequency = 20, .largest_strain = 0.03});
        const CyclicState& s = test.run();
        CHECK(s.responses.rows() == 0);
        const auto& strain = test.test.state().curves[quantity::axial_strain];
        CHECK(strain.back() >= 0.03);
        CHECK(strain.back() < 0.04);
        CHECK(s.loops.rows() > 2);
    }

    TEST_CASE(
        "a cyclic test that is continued in a half cycle, on two threads, has the same bits") {
        const LoadCycles cycles{.count = 2,
                                .largest_q = 50e3,
                                .frequency = 50,
                                .restitution = 0.5,
                                .damping = 0.3,
                                .rest_every = 1,
                                .rest = 0.005};
        SpecimenSettings rocks;
        rocks.law = LawName::linear_edges;
        rocks.edges = {.friction_rise = 0.3,
                       .friction_half_force = 60,
                       .couple_arm = 0.003,
                       .couple_force = 60};
        CyclicTest whole(cycles, 1, rocks);
        Archive middle;
        bool kept = false;
        while (whole.test.advance()) {
            const CyclicState& s = whole.test.state().cyclic;
            if (kept || s.halves != 1 || s.points != 5) continue;
            middle = whole.simulation.snapshot();
            kept = true;
        }
        REQUIRE(kept);
        CyclicTest rest(cycles, 2, rocks, &middle);
        rest.run();
        CHECK(fingerprint(rest.simulation.snapshot()) == fingerprint(whole.simulation.snapshot()));
        CHECK(rest.test.state().cyclic.responses[&CyclicResponse::axial_strain] ==
              whole.test.state().cyclic.responses[&CyclicResponse::axial_strain]);
    }

    TEST_CASE("cycles that contradict each other or the pressure are refused by the name of the "
              "option") {
        const auto refused = [](const LoadCycles& cycles, const std::string& words) {
            INFO(words);
            try {
                check_cycles(cycles, LawName::linear, 10e3);
                FAIL_CHECK("accepted");
            } catch (const InputError& error) {
                CHECK(std::string(error.what()).starts_with(words));
            }
        };
        check_cycles({}, LawName::linear, 10e3);
        check_cycles({.count = 3}, LawName::linear, 10e3);
        refused({.count = 3, .least_q = 300e3}, "--least-q: expected less than --largest-q");
        refused({.count = 3, .least_q = -10e3}, "--least-q: expected above minus");
        refused({.count = 3, .frequency = 0, .platen_mass = 2}, "--platen-mass");
        refused({.count = 3, .restitution = 0.5}, "--restitution: expected a --law");
        refused({.count = 3, .rest_every = 5}, "--rest-every, --rest");
        refused({.count = 3, .frequency = 0, .rest_every = 5, .rest = 1}, "--rest:");
    }
}
