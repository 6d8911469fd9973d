#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/specimens/saved_world.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/fields/container.hpp"
#include "systems/steps.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/small_specimen.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

using namespace bris;
using testing::prepared, testing::pressure, testing::short_test, testing::small_scene;

namespace {

Simulation small_test(unsigned threads, ListSettings lists = {}, ScheduleSettings schedule = {}) {
    const TriaxialScene s = small_scene();
    World world = make_triaxial_world(s.specimen, s.clumps, s.smart_rocks, s.sample.rocks, s.poses);
    add_lists(world, LawName::linear, lists);
    add_energy_budget(world);
    world.add_resource<TriaxialState>();
    schedule.least_rows = 0; // the scene is small, but the threads are to be tested
    Simulation simulation(std::move(world), steps(LawName::linear, true), threads, schedule);
    simulation.on_restore(forget_lists);
    return simulation;
}

/// Makes all samples from the k-th on unusable: empty, or outliers by 20 mm and half a radian.
void let_die(std::vector<SensorTrajectory>& trajectories, std::size_t k) {
    for (SensorTrajectory& trajectory : trajectories) {
        trajectory.tilt.assign(trajectory.strain.size(), Vec3::Constant(std::nan("")));
        for (std::size_t n = k; n < trajectory.strain.size(); ++n) {
            const double off = n % 3 == 0 ? std::nan("") : 1;
            trajectory.displacement[n] += off * Vec3(0.02, 0, 0);
            trajectory.rotation[n] += off * Vec3(0, 0, 0.5);
        }
    }
}

void end(std::vector<SensorTrajectory>& trajectories, std::size_t k) {
    for (SensorTrajectory& trajectory : trajectories) {
        trajectory.strain.resize(k);
        trajectory.displacement.resize(k);
        trajectory.rotation.resize(k);
    }
}

void check_same_bits(const ModelRun& a, const ModelRun& b) {
    CHECK(a.displacement == b.displacement);
    CHECK(a.rotation == b.rotation);
    CHECK(a.steps == b.steps);
    CHECK(a.boundary_work == b.boundary_work);
    CHECK(a.fusion_work == b.fusion_work);
}

/// Sum of the radii (m) of the edges that have yielded between rocks.
double sum_of_worn(const World& world) {
    if (!world.table<SpherePairs>().has<Worn>()) return 0;
    double sum = 0;
    for (const double radius : world.column<SpherePairs, Worn>()) sum += radius;
    return sum;
}

} // namespace

TEST_SUITE("triaxial/triaxial") {
    TEST_CASE("a triaxial test keeps its pressure, its stress balance and its energy balance, also "
              "with printed shells on its sensor rocks") {
        for (const SpecimenSettings& specimen :
             {SpecimenSettings{},
              SpecimenSettings{.sensor_density = 1200, .sensor_friction = 0.25}}) {
            Simulation simulation = make_simulation(small_scene(specimen), 1);
            TriaxialTest test(simulation, short_test());
            while (test.advance()) {
            }
            const TestCurves& curves = test.state().curves;
            REQUIRE(curves.size() == 21);
            const TriaxialProperties p = properties_of(curves, pressure);
            CHECK(p.worst_ring_error <= 0.01); // the criterion of a stage

            // a few tens of the unbalanced ratio, because branch vectors are long
            CHECK(p.worst_stress_mismatch <= 0.01);
            MESSAGE("energy mismatch ", p.relative_energy_error, ", stress mismatch ",
                    p.worst_stress_mismatch);
            CHECK(p.relative_energy_error <= 0.01);
            // at 0.2 % of strain a loose and tiny specimen is far from its peak
            CHECK(p.peak_q > 0.1 * pressure);
            CHECK(curves[quantity::axial_strain].back() == about(0.002).epsilon(1e-9));
            for (std::size_t k = 1; k < curves.size(); ++k)
                CHECK(curves[quantity::unbalanced_ratio][k] <= 1e-3);
            const auto& materials = simulation.world().resource<Materials>();
            const std::uint32_t sensor = simulation.world().resource<Specimen>().sensor_material;
            CHECK(materials.list[sensor].friction ==
                  (specimen.sensor_friction < 0 ? short_test().friction : 0.25));
        }
    }

    TEST_CASE(
        "a specimen prepared with linear contacts is tested with Hertz-Mindlin contacts and with "
        "edges that yield, with the same balances and the same bits on two threads") {
        const Archive specimen = prepared(small_scene());
        // J, at the start of shearing
        const auto stored = [&](LawName law, double confining, unsigned threads,
                                std::uint64_t* bits = nullptr) {
            SpecimenSettings rocks;
            rocks.law = law;
            if (traits(law).edges)
                rocks.edges = {.contact_strength = 1.5e9,
                               .cone_half_angle = 1.2,
                               .edge_radius = 0.005,
                               .friction_rise = 0.3,
                               .friction_half_pressure = 2e8,
                               .couple_arm = 0.003,
                               .couple_force = 60};
            const TriaxialScene scene = small_scene(rocks);
            TriaxialSettings settings = short_test();
            settings.confining_pressure = confining;
            settings.final_axial_strain = 1e-3;
            Simulation simulation = make_simulation(scene, threads);
            restore_specimen(simulation, scene, specimen);
            TriaxialTest test(simulation, settings);
            while (test.advance()) {
            }
            const TestCurves& curves = test.state().curves;
            REQUIRE(curves.size() == 11);
            const TriaxialProperties p = properties_of(curves, confining);
            CHECK(p.worst_ring_error <= 0.01);
            CHECK(p.worst_stress_mismatch <= 0.01);
            CHECK(p.relative_energy_error <= 0.01);
            CHECK((sum_of_worn(simulation.world()) > 0) == has_wear(law));
            if (bits != nullptr) *bits = fingerprint(simulation.snapshot());
            return curves[quantity::stored_energy][0];
        };
        std::uint64_t one = 0, two = 0;
        const LawName mindlin = LawName::hertz_mindlin, plain = LawName::linear;
        const double hertz = stored(mindlin, 440e3, 1, &one) / stored(mindlin, 55e3, 1),
                     linear = stored(plain, 440e3, 1) / stored(plain, 55e3, 1);
        (void)stored(mindlin, 440e3, 2, &two);
        CHECK(one == two);
        (void)stored(LawName::hertz_edges, 110e3, 1, &one);
        (void)stored(LawName::hertz_edges, 110e3, 2, &two);
        CHECK(one == two);
        // Energy grows as p^(5/3) and p^2 if the contacts stay the same; more of them form under
        // the higher pressure, to about the same extent with either law.
        MESSAGE("stored energy ", hertz, " and ", linear);
        CHECK(hertz / linear == about(std::pow(8, -1.0 / 3)).epsilon(0.2));
    }

    TEST_CASE("a specimen prepared within rings is tested in a sleeve of latex, with the same "
              "balances, and the same bits on two threads and from a checkpoint") {
        const Archive specimen = prepared(small_scene());
        SpecimenSettings latex;
        latex.membrane = MembraneKind::latex;
        const TriaxialScene scene = small_scene(latex);
        TriaxialSettings settings = short_test();
        settings.final_axial_strain = 1e-3;
        Archive half_way;
        const auto run = [&](unsigned threads, const Archive& from, bool resumes) {
            Simulation simulation = make_simulation(scene, threads);
            if (resumes)
                simulation.restore(from);
            else
                restore_specimen(simulation, scene, from);
            TriaxialTest test(simulation, settings);
            while (test.advance())
                if (!resumes && test.state().stage == 5) half_way = simulation.snapshot();
            CHECK(test.state().curves.size() == 11);
            return std::pair{test.state().curves, simulation.snapshot()};
        };
        const auto [curves, one] = run(1, specimen, false);
        const auto bits = fingerprint(one);
        CHECK(fingerprint(run(2, specimen, false).second) == bits);
        CHECK(fingerprint(run(1, half_way, true).second) == bits);

        const TriaxialProperties p = properties_of(curves, pressure);
        MESSAGE("energy mismatch ", p.relative_energy_error, ", stress mismatch ",
                p.worst_stress_mismatch);
        CHECK(p.worst_stress_mismatch <= 0.01);
        CHECK(p.relative_energy_error <= 0.01);
        CHECK(p.peak_q > 0.1 * pressure);
        for (const double radial : curves[quantity::radial_stress]) CHECK(radial == pressure);
        // fields measure the space inside the sleeve, from the checkpoint alone
        const Vec3 far = Vec3::Constant(std::numeric_limits<double>::infinity());
        const Box3 space = Container(world_of_state(one), {-far, far}).bounds();
        CHECK(space.high.x() == about(scene.specimen.radius).epsilon(0.1));
    }

    TEST_CASE("settings of latex are refused where rings hold the specimen") {
        Triaxial settings;
        check_test(settings);
        settings.specimen.latex.thickness = 7e-3;
        CHECK(refusal_of([&] { check_test(settings); }).find("expected --membrane latex") !=
              std::string::npos);
        settings.specimen.membrane = MembraneKind::latex;
        check_test(settings);
    }

    TEST_CASE("the progress of a test names in each phase what is awaited, with its target") {
        Simulation simulation = make_simulation(small_scene(), 1);
        TriaxialSettings settings = short_test();
        settings.final_axial_strain = 2e-4;
        TriaxialTest test(simulation, settings);
        std::map<std::string, PhaseProgress> last;
        bool falls = false;
        while (test.advance()) {
            const PhaseProgress now = test.progress();
            falls = falls || (now.phase == "filling" && now.fraction < last[now.phase].fraction);
            last[now.phase] = now;
        }
        CHECK_FALSE(falls);
        CHECK(last["filling"].fraction > 0.9);
        CHECK(last["filling"].fraction < 1);
        CHECK(last["filling"].status.starts_with("rocks at 9"));
        CHECK(last["preparation"].status.find("(target 0.380), tap 4") != std::string::npos);
        const std::string at = fmt::format("{:.0f} kPa ", pressure / 1e3);
        CHECK(last[at + "consolidation"].status.find("(target 3e-04), pressure error ") !=
              std::string::npos);
        CHECK(last[at + "shear"].status.starts_with("axial strain 0.02 of 0.02 %, q "));
        CHECK(last[at + "shear"].fraction == about(1));
        CHECK(last[at + "shear"].work == 3); // points: at the start and after each stage
    }

    TEST_CASE("a test restored from any phase ends with the same bits, whatever the threads, "
              "schedule and "
              "neighbour lists") {
        Simulation simulation = small_test(1);
        TriaxialTest test(simulation, short_test());
        // while it is filled, compressed and tapped, at the start of consolidation and of a stage,
        // and within a stage
        std::vector<Archive> saved;
        const auto reached = [&] {
            const TriaxialState& s = test.state();
            switch (saved.size()) {
            case 0:
                return s.phase == TriaxialPhase::fill && s.phase_steps > 1000;
            case 1:
                return s.phase == TriaxialPhase::compress && s.poured_porosity > 0;
            case 2:
                return s.phase == TriaxialPhase::tap && s.taps == 2;
            case 3:
                return s.phase == TriaxialPhase::consolidate;
            case 4:
                return s.phase == TriaxialPhase::shear && s.stage == 1 && s.phase_steps == 0;
            case 5:
                return s.phase == TriaxialPhase::shear && s.stage == 1 && s.phase_steps > 0;
            default:
                return false;
            }
        };
        while (test.state().stage < 2) {
            REQUIRE(test.advance());
            if (reached()) saved.push_back(simulation.snapshot());
        }
        REQUIRE(saved.size() == 6);
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
        // one specimen serves for tests with other friction coefficients
        {
            Simulation other = small_test(1);
            other.restore(saved[3]);
            TriaxialSettings rough = short_test();
            rough.friction = 0.9;
            (void)TriaxialTest(other, rough).advance();
            CHECK(other.world()
                      .resource<Materials>()
                      .list[other.world().resource<Specimen>().rock_material]
                      .friction == 0.9);
        }
        // independent of threads, task graph, order of execution, sorting and skins
        const Archive& stage = saved[4];
        for (const unsigned threads : {1u, 2u, 3u, 7u})
            CHECK(end_from(stage, small_test(threads, {}, {.grain = 16})) == whole);
        CHECK(end_from(stage, small_test(2, {}, {.overlap = true})) == whole);
        CHECK(end_from(stage, small_test(2, {}, {.last_order = true, .grain = 16})) == whole);
        CHECK(end_from(stage, small_test(1, {.sort_every = 0})) == whole);
        CHECK(end_from(stage, small_test(1, {.sort_every = 1})) == whole);
        CHECK(end_from(stage,
                       small_test(1, {.outer_skin = 0.002, .inner_skin = 0.0002, .tune = false})) ==
              whole);
        CHECK(end_from(stage,
                       small_test(1, {.outer_skin = 0.005, .inner_skin = 0.001, .tune = false})) ==
              whole);
    }

    TEST_CASE(
        "a model that assimilates the motions of the sensor rocks is corrected at every stage, "
        "and reports the work of the corrections") {
        const TriaxialScene scene = small_scene();
        const Archive specimen = prepared(scene);
        const auto run = [&](const ModelVariant& variant) {
            return run_model(scene, short_test(), specimen, variant);
        };
        const ModelRun truth = run({});
        ModelVariant variant;
        variant.rocks.friction = 0.3;
        const ModelRun free = run(variant);
        variant.trajectories =
            recorded_trajectories(truth, sensor_rocks(truth), 1e-4, 1e-7, 1e-5, 1);
        variant.corrections.position_noise = 1e-7;
        variant.corrections.attitude_noise = 1e-5;
        // m; without the limit corrections may push rocks into each other until a guard stops the
        // run
        variant.corrections.largest_shift = 3e-6;
        variant.corrections.filter = {.acceleration_density = 1,
                                      .angular_acceleration_density = 100,
                                      .drift = 1e-6,
                                      .turning = 1e-2,
                                      .gate = 1};
        const ModelRun fused = run(variant);
        const TwinErrors same = errors_of(run({}), truth), without = errors_of(free, truth);
        CHECK(same.q == 0);
        CHECK(same.displacement[1] == 0);
        CHECK(without.q > 1e3);
        CHECK(without.displacement[1] > 1e-6);
        CHECK(fused.accepted == 4 * 10 * 20); // positions, attitudes, and their rates of zero
        CHECK(fused.refused == 0);
        REQUIRE(fused.analyses.size() == 10 * 20);
        CHECK(std::ranges::is_sorted(fused.analyses, {}, &AnalysisRecord::time));
        CHECK(fused.analyses.back().time == about(2e-3));
        for (const AnalysisRecord& r : fused.analyses)
            CHECK(r.position_deviation < 1.01e-7); // observed to 0.1 micron
        CHECK(fused.fusion_work > 0);
        CHECK(fused.steps > free.steps); // the stages come to rest again
        CHECK(*std::max_element(truth.shell.begin(), truth.shell.end()) >= 2);
        CHECK(std::count(truth.shell.begin(), truth.shell.end(), 0u) == 10);
        // without recordings, or with empty ones, nothing is different
        variant.trajectories.assign(10, {});
        const ModelRun deaf = run(variant);
        CHECK(errors_of(deaf, free).q == 0);
        CHECK(deaf.fusion_work == 0);

        // given another friction coefficient in the middle, the run catches up as if it had been
        // known from the beginning
        variant = {.rocks = {.friction = 0.3}, .learned = {{1e-3, {.friction = 0.7}}}};
        const ModelRun catches_up = run(variant);
        for (std::size_t k = 0; k < truth.curves.size(); ++k)
            CHECK(catches_up.curves[quantity::deviatoric_stress][k] ==
                  (k <= 10 ? free : truth).curves[quantity::deviatoric_stress][k]);
        CHECK(catches_up.steps > truth.steps);
    }

    TEST_CASE("the work of corrections by insertion or nudging closes the energy balance") {
        const TriaxialScene scene = small_scene();
        const Archive specimen = prepared(scene);
        const auto run = [&](const ModelVariant& variant) {
            return run_model(scene, short_test(), specimen, variant);
        };
        const ModelRun truth = run({});
        ModelVariant variant{
            .rocks = {.friction = 0.3},
            .trajectories = recorded_trajectories(truth, sensor_rocks(truth), 1e-4, 1e-7, 1e-5, 1)};
        variant.corrections.position_noise = 1e-7;
        variant.corrections.attitude_noise = 1e-5;
        variant.corrections.largest_shift = 1e-6;
        for (const bool nudged : {false, true}) {
            variant.corrections.nudging = {nudged ? 5e6 : 0, 100, 0.01};
            const ModelRun r = run(variant);
            CAPTURE(nudged);
            MESSAGE("work of corrections: ", r.fusion_work / r.boundary_work,
                    " of the boundaries' work");
            CHECK(std::abs(r.fusion_work) > 0.02 * r.boundary_work);
            const auto rise = [&](const Quantity& q) {
                return r.curves[q].back() - r.curves[q].front();
            };
            using namespace quantity;
            const double checkpoint = rise(stored_energy) + rise(kinetic_energy),
                         lost = rise(friction_work) + rise(damping_work),
                         work = rise(boundary_work) + rise(scaling_work);
            CHECK(std::abs(work + r.fusion_work - checkpoint - lost) <
                  5e-4 * work); // 1e-4 without corrections
        }
    }

    TEST_CASE(
        "a model whose sensors fail continues as if their recordings had ended, and one whose "
        "sensors never worked as if it had none") {
        const TriaxialScene scene = small_scene();
        const Archive specimen = prepared(scene);
        TriaxialSettings settings = short_test();
        settings.final_axial_strain = 0.001;
        const auto run = [&](const ModelVariant& variant) {
            return run_model(scene, settings, specimen, variant);
        };
        const ModelRun truth = run({});
        ModelVariant variant{.rocks = {.friction = 0.3}};
        const ModelRun free = run(variant);
        variant.corrections.position_noise = 1e-7;
        variant.corrections.attitude_noise = 1e-5;
        variant.corrections.largest_shift = 3e-6;
        variant.corrections.filter.gate = 0.999;
        const auto trajectories =
            recorded_trajectories(truth, sensor_rocks(truth), 1e-4, 1e-7, 1e-5, 1);
        variant.trajectories = trajectories;
        end(variant.trajectories, 4);
        const ModelRun ended = run(variant);
        variant.trajectories = trajectories;
        let_die(variant.trajectories, 4);
        const ModelRun died = run(variant);
        CHECK(ended.fusion_work != 0);
        CHECK(ended.steps != free.steps);
        CHECK(died.accepted == ended.accepted);
        CHECK(died.refused ==
              ended.refused + 2 * 10 * 4); // positions and attitudes; two of six samples are empty
        check_same_bits(died, ended);
        let_die(variant.trajectories, 0);
        const ModelRun dead = run(variant);
        CHECK(dead.accepted == 0);
        CHECK(dead.refused > 0);
        check_same_bits(dead, free);
    }

    TEST_CASE(
        "a model stopped anywhere, with observations to come and corrections under way, resumes "
        "to the same bits") {
        const TriaxialScene scene = small_scene();
        const Archive specimen = prepared(scene);
        const ModelRun truth = run_model(scene, short_test(), specimen, {});
        ModelVariant variant{
            .rocks = {.friction = 0.4},
            .learned = {{1e-3, {.friction = 0.6}}},
            .trajectories = recorded_trajectories(truth, sensor_rocks(truth), 1e-4, 1e-7, 1e-5, 1)};
        for (const bool inserted : {false, true}) {
            variant.corrections.nudging = {inserted ? 0 : 1e6, 50, 0.01};
            variant.corrections.largest_shift = 1e-7;
            unsigned blocks = 0;
            Archive whole, gone_on;
            save_run(whole, run_model(scene, short_test(), specimen, variant,
                                      {.progress = [&](const PhaseProgress&) { ++blocks; }}));
            CAPTURE(blocks);
            const TemporaryDirectory folder;
            Common common;
            common.out = common.resume = folder.path();
            struct Stop {};
            unsigned block = 0;
            // each run resumes from the one before
            for (const unsigned last : {blocks / 7, blocks / 2, blocks - 20}) {
                CheckpointedRun checkpoint(common, short_test(), specimen, variant);
                const ModelWatch watch{.progress = [&](const PhaseProgress&) {
                    ++block;
                    if (block == last) checkpoint.timer() = CheckpointTimer(0);
                    if (block > last) throw Stop();
                }};
                CHECK(checkpoint.resume().has_value() == (block > 0));
                CHECK_THROWS_AS(
                    run_model(scene, short_test(), specimen, variant, watch, &checkpoint), Stop);
                --block; // it is not in the checkpoint
            }
            CheckpointedRun checkpoint(common, short_test(), specimen, variant);
            save_run(gone_on, run_model(scene, short_test(), specimen, variant, {}, &checkpoint));
            for (const auto& array : whole.arrays()) {
                CAPTURE(array.path);
                if (array.path != "run/numbers") // these include a wall time
                    CHECK(array.bytes == gone_on.find(array.path)->bytes);
            }
            const ModelRun a = load_run(whole), b = load_run(gone_on);
            CHECK(a.steps == b.steps);
            CHECK(a.accepted == b.accepted);
            CHECK(a.fusion_work == b.fusion_work);
            CHECK(a.reduced == b.reduced);
            CHECK((a.reduced > 0) == inserted); // nudging has a limit of its own
            CHECK(a.boundary_work == b.boundary_work);
            // a finished run is not run again; another variant is another run
            unsigned run_again = 0;
            const ModelWatch watch{.progress = [&](const PhaseProgress&) { ++run_again; }};
            CHECK(run_model(scene, short_test(), specimen, variant, watch, &checkpoint)
                      .curves.size() == 21);
            CHECK(run_again == 0);
            variant.rocks.friction = 0.41;
            CHECK_FALSE(
                CheckpointedRun(common, short_test(), specimen, variant).resume().has_value());
            variant.rocks.friction = 0.4;
        }
    }
}
