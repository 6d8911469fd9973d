#include "components/platen.hpp"
#include "components/slab.hpp"
#include "engine/random.hpp"
#include "engine/ranks.hpp"
#include "engine/state.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/fields/initial_fouling.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/loads/rail.hpp"
#include "systems/servo/membrane.hpp"
#include "systems/slabs/slabs.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/steps.hpp"
#include "tests/edges.hpp"
#include "tests/extreme_scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

using namespace bris;

namespace {

/// The first array that differs; empty if all are equal.
std::string difference(const Archive& a, const Archive& b) {
    for (const auto& array : a.arrays()) {
        const auto* other = b.find(array.path);
        if (other == nullptr) return array.path + " is missing";
        if (array.bytes != other->bytes) return array.path + " differs";
    }
    return a.arrays().size() == b.arrays().size() ? "" : "another number of arrays";
}

SmallSceneSettings plain() {
    return {.dt = 2e-5,
            .law = LawName::linear_viscous,
            .lists = {.outer_skin = 0.002, .inner_skin = 0.0004, .sort_every = 3, .tune = false},
            .schedule = {.grain = 16}};
}

Archive undivided(World world, const SmallSceneSettings& settings, std::uint64_t steps) {
    Simulation simulation = begin(std::move(world), settings);
    simulation.divide({});
    simulation.advance(steps);
    return simulation.snapshot();
}

/// A long heap of grains which roll along x, from one slab into the next.
World long_heap(Grains grains, Walls walls, unsigned bodies, std::uint64_t seed) {
    World world = bed({.grains = grains, .walls = walls, .bodies = bodies, .seed = seed});
    world.resource<Gravity>().value = Vec3(30, 0, -30);
    return world;
}

void add_plate_on_springs(World& world, const Vec3& middle, double side) {
    const EntityId plate =
        add_block(world, middle, Quat(Quat::Identity()), Vec3(side, side, 0.004), 0.02, 1);
    for (const double x : {-side / 3, side / 3})
        for (const double y : {-side / 3, side / 3})
            add_patch(world, plate,
                      {.point = Vec3(x, y, 0),
                       .anchor = middle + Vec3(x, y, 0),
                       .stiffness = 4e3,
                       .damping = 2});
}

/// Two ties under a rail, one of them under a load, fall onto clumps; plates on springs lie under
/// them.
World tie_scene(std::uint64_t seed, unsigned plates = 1) {
    const Tumble tumble{.grains = Grains::clumps, .bodies = 60};
    World world = bed({.grains = Grains::clumps, .bodies = 60, .seed = seed});
    const Vec3 box = box_of(tumble);
    Random draw(seed, 1);
    for (unsigned k = 0; k < plates; ++k) {
        const double x = plates == 1 ? 0.5 : draw.uniform(), y = plates == 1 ? 0.5 : draw.uniform();
        add_plate_on_springs(world, Vec3(x * box.x(), y * box.y(), -0.0018), 0.03);
    }
    const EntityId tie =
        add_block(world, Vec3(box.x() / 2, box.y() / 2, 0.75 * box.z()),
                  exponential_map(Vec3(0.2, 0.1, 0)), Vec3(0.02, 0.035, 0.015), 0.02, 1);
    value_of<Velocity>(world, tie) = Vec3(0, 0, -2);
    add_load(world, tie,
             {.force = Vec3(0, 0, -1),
              .point = Vec3(0.002, 0.01, 0),
              .history = {.mean = 1, .amplitude = 0.8, .frequency = 100}});
    const EntityId next = add_block(world, Vec3(0.9 * box.x(), box.y() / 2, 0.75 * box.z()),
                                    Quat(Quat::Identity()), Vec3(0.012, 0.035, 0.012), 0.01, 1);
    add_rail(world, {.bending = 0.02,
                     .pad = 4e3,
                     .weight = 1,
                     .axle_positions = {0.6 * box.x()},
                     .axle_loads = {1},
                     .axle_speed = 1,
                     .seats = {{.tie = tie}, {.tie = next}}});
    return world;
}

/// Grains in a box inside a membrane whose servo holds a pressure.
World tube_scene(Grains grains, bool latex = false) {
    World world = bed({.grains = grains, .walls = Walls::planes, .bodies = 45, .seed = 9});
    const auto wall = world.resource<Materials>().add({"membrane", 0, 4e5, 0, 0, 500, 0});
    // to the middle of the tube, together with the box
    for (Vec3& x : world.column<Bodies, Position>()) x -= Vec3(0.028, 0.028, -0.003);
    add_tube(world,
             {.rings = 3,
              .sectors = 8,
              .radius = 0.045,
              .height = 0.1,
              .pressure = 2e3,
              .contact_stiffness = 8e4,
              .latex = latex},
             wall);
    return world;
}

/// A heap that slides through its fines.
World fouled_heap(const FoulingSettings& settings) {
    World world = long_heap(Grains::clumps, Walls::planes, 60, 4);
    add_fouling(world, settings);
    fill_with_fines(world, {.p4 = 10, .p200 = 2, .saturation = 0.5});
    return world;
}

/// A heap of which some grains record where they should be, every three milliseconds.
World heap_with_sensors(Grains grains, const NudgingSettings& nudging) {
    World world = long_heap(grains, Walls::planes, 60, 6);
    std::vector<EntityId> hosts;
    std::vector<std::vector<TimedMeasurement>> samples;
    const auto id = world.column<Bodies, BodyId>();
    const auto position = world.column<Bodies, Position>();
    const auto mass = world.column<Bodies, Mass>();
    for (Row b = 3; b < mass.size(); b += 11) {
        if (!(mass[b] > 0)) continue;
        hosts.push_back(id[b]);
        samples.emplace_back();
        for (int k = 1; k <= 8; ++k) {
            TimedMeasurement m{.time = 3e-3 * k, .what = {}};
            m.what.position = position[b] + Vec3(1e-4 * k, 0, -1e-4 * k);
            m.what.position_deviation = 1e-4;
            samples.back().push_back(m);
        }
    }
    add_sensors(world, hosts, samples, {.position = 1e-3, .velocity = 0.1, .gate = 1}, 10);
    world.resource<Fusion>().nudging = nudging;
    return world;
}

std::int64_t over_ranks(std::int64_t here) {
    Ranks::sum({&here, 1});
    return here;
}

} // namespace

TEST_SUITE("ranks") {
    TEST_CASE("a world that is divided among ranks gives the bits of one that is not") {
        REQUIRE(Ranks::size() > 1);
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const Walls walls : {Walls::planes, Walls::facets})
                for (const bool budget : {false, true}) {
                    CAPTURE(static_cast<int>(grains));
                    CAPTURE(static_cast<int>(walls));
                    CAPTURE(budget);
                    const auto make = [&] { return long_heap(grains, walls, 90, 7); };
                    SmallSceneSettings settings = plain();
                    settings.energy_budget = budget;
                    const Archive whole = undivided(make(), settings, 1600);
                    REQUIRE(whole.find("sphere_pairs/key")->rows() > 4);
                    Simulation divided = begin(make(), settings);
                    for (const std::uint64_t steps : {1u, 499u, 25u, 300u, 775u})
                        divided.advance(steps);
                    CHECK(difference(whole, divided.snapshot()) == "");
                }
    }

    TEST_CASE("each body has one owner, and most bodies are on one rank only") {
        Simulation divided = begin(long_heap(Grains::spheres, Walls::planes, 400, 3), plain());
        divided.advance_unseen(900);
        REQUIRE(divided.part() != nullptr);
        const World& part = *divided.part();
        std::int64_t own = 0, ghosts = 0, walls = 0;
        const auto run = part.column<Bodies, SpheresOf>();
        const auto ghost = part.column<Bodies, Ghost>();
        for (Row b = 0; b < run.size(); ++b)
            ++(run[b].count == 0 ? walls : ghost[b] != 0 ? ghosts : own);
        CHECK(own > 0);
        CHECK(ghosts > 0);
        CHECK(over_ranks(own) == 400);
        CHECK(over_ranks(ghosts) < 400 * (Ranks::size() - 1) / 2 + 100);
        // ghosts have the last rows
        CHECK(part.resource<Slab>().first_ghost + static_cast<std::size_t>(ghosts) == ghost.size());
        CHECK(std::is_sorted(ghost.begin(), ghost.end()));
        divided.look();
        CHECK(divided.part() == nullptr);
        CHECK(divided.step() == 900);
    }

    TEST_CASE(
        "all ranks make new lists in the same steps, for none of them waits then, and lists of "
        "the whole world for one step have no candidates that are not near") {
        Simulation divided = begin(long_heap(Grains::clumps, Walls::planes, 120, 5), plain());
        divided.advance_unseen(200);
        REQUIRE(divided.part() != nullptr);
        const std::uint64_t rebuilds = divided.part()->resource<ListState>().rebuilds;
        std::uint64_t prunes = 0, last = 0;
        for (int k = 0; k < 300; ++k) {
            divided.advance_unseen(3);
            const ListState& lists = divided.part()->resource<ListState>();
            CHECK(Ranks::largest(static_cast<double>(lists.last_prune)) ==
                  static_cast<double>(lists.last_prune));
            if (std::exchange(last, lists.last_prune) != lists.last_prune) ++prunes;
        }
        CHECK(prunes > 5);
        CHECK(prunes > divided.part()->resource<ListState>().rebuilds - rebuilds);
        divided.look();
        CHECK(divided.world().table<SpherePairs>().size() ==
              divided.world().resource<NearIndex<SpherePairs>>().size());
    }

    TEST_CASE("single spheres are moved and passed on by one system, with the same bits as by "
              "those that it combines") {
        SmallSceneSettings settings = plain();
        const auto make = [] { return long_heap(Grains::spheres, Walls::planes, 120, 11); };
        Simulation together = begin(make(), settings);
        together.advance_unseen(1000);
        REQUIRE(together.part() != nullptr);
        World copy(*together.part());
        Schedule schedule(steps(settings.law));
        schedule.prepare(copy);
        const std::string text = schedule.explain();
        CHECK(text.find("rotate_spheres + pass_spheres + update_sphere_positions") !=
              std::string::npos);
        settings.schedule.combined = false;
        Simulation apart = begin(make(), settings);
        apart.advance_unseen(1000);
        together.look();
        apart.look();
        CHECK(difference(together.snapshot(), apart.snapshot()) == "");
    }

    TEST_CASE("ties with loads, and plates on springs, feel the contacts of all ranks") {
        SmallSceneSettings settings = plain();
        settings.energy_budget = true;
        for (const unsigned plates : {1u, 8u}) { // each rank sorts the rows of eight in its own way
            CAPTURE(plates);
            const Archive whole = undivided(tie_scene(5, plates), settings, 1500);
            Simulation divided = begin(tie_scene(5, plates), settings);
            divided.advance(1500);
            CHECK(difference(whole, divided.snapshot()) == "");
        }
    }

    TEST_CASE("the work of walls that turn about a fixed centre is that of all contacts") {
        const auto make = [] {
            World world = long_heap(Grains::clumps, Walls::facets, 60, 8);
            const auto mass = world.column<Bodies, Mass>();
            for (Row b = 0; b < mass.size(); ++b)
                if (!(mass[b] > 0)) world.column<Bodies, AngularVelocity>()[b] = Vec3(0, 0, 3);
            return world;
        };
        SmallSceneSettings settings = plain();
        settings.energy_budget = true;
        const Archive whole = undivided(make(), settings, 1200);
        CHECK(std::ranges::count(whole.get<double>("bodies/boundary_work"), 0.0) <
              static_cast<std::ptrdiff_t>(whole.find("bodies/boundary_work")->rows()));
        Simulation divided = begin(make(), settings);
        divided.advance(1200);
        CHECK(difference(whole, divided.snapshot()) == "");
    }

    TEST_CASE("a membrane, rigid or of latex, feels the contacts of all ranks") {
        for (const auto& [grains, latex] :
             {std::pair{Grains::spheres, false}, std::pair{Grains::clumps, false},
              std::pair{Grains::spheres, true}, std::pair{Grains::clumps, true}}) {
            CAPTURE(static_cast<int>(grains));
            CAPTURE(latex);
            SmallSceneSettings settings = plain();
            settings.energy_budget = grains == Grains::clumps;
            const Archive whole = undivided(tube_scene(grains, latex), settings, 1500);
            Simulation divided = begin(tube_scene(grains, latex), settings);
            divided.advance(700);
            divided.advance(800);
            CHECK(difference(whole, divided.snapshot()) == "");
        }
    }

    TEST_CASE("a platen that holds its pressure feels, and counts, the contacts of all ranks") {
        const auto make = [] {
            World world = tube_scene(Grains::clumps);
            auto& platen = world.resource<Platen>();
            platen.controlled = true;
            platen.target_pressure = 1e3;
            platen.contact_stiffness = 2e4;
            platen.largest_step = 2e-5;
            return world;
        };
        const Archive whole = undivided(make(), plain(), 3000);
        Simulation divided = begin(make(), plain());
        divided.advance(3000);
        CHECK(divided.world().resource<Platen>().stiffness > 2 * 2e4); // it has met grains
        CHECK(difference(whole, divided.snapshot()) == "");
    }

    TEST_CASE("inertial recorders on rocks and on a tie record the same on any number of ranks") {
        const auto run = [&](bool divided) {
            World world = tie_scene(6);
            ImuModel model;
            model.rate = 2000;
            const auto ids = world.column<Bodies, BodyId>();
            std::vector<EntityId> with_recorder{ids.back()}; // the tie
            for (std::size_t k = 10; k < ids.size() - 2; k += 7) with_recorder.push_back(ids[k]);
            for (const EntityId body : with_recorder)
                add_recorder(world, body, model, Vec3(0, 0, -9.81), 3);
            start_recording(world);
            Simulation simulation = begin(std::move(world), plain());
            if (!divided) simulation.divide({});
            for (const std::uint64_t steps : {700u, 90u, 710u}) simulation.advance(steps);
            return simulation.snapshot();
        };
        const Archive whole = run(false);
        CHECK(difference(whole, run(true)) == "");
    }

    TEST_CASE("fines and water move, and weaken contacts, as without ranks") {
        FoulingSettings settings{.voxel = 5e-3, .samples = 2, .refresh = 0.05, .check_every = 40};
        for (const double pumping : {0.0, 1e-2}) { // the second: fields change at every check
            CAPTURE(pumping);
            settings.pumping = pumping;
            settings.drains = pumping > 0;
            Simulation whole = begin(fouled_heap(settings), plain());
            whole.divide({});
            whole.advance(900);
            CHECK(whole.world().resource<Fouling>().updates > 3);
            Simulation divided = begin(fouled_heap(settings), plain());
            divided.advance_unseen(115);
            CHECK(divided.part() != nullptr);
            divided.advance(785);
            CHECK(difference(whole.snapshot(), divided.snapshot()) == "");
        }
    }

    TEST_CASE("recordings of sensors correct the motion as without ranks") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const double stiffness : {0.0, 500.0}) {
                CAPTURE(static_cast<int>(grains));
                CAPTURE(stiffness);
                const auto make = [&] {
                    return heap_with_sensors(grains, {.stiffness = stiffness, .largest_force = 1});
                };
                Simulation whole = begin(make(), plain());
                whole.divide({});
                whole.advance(1300);
                CHECK(fusion_work(whole.world()) != 0);
                Simulation divided = begin(make(), plain());
                divided.advance_unseen(500);
                CHECK(divided.part() != nullptr);
                divided.advance(800);
                CHECK(difference(whole.snapshot(), divided.snapshot()) == "");
            }
    }

    TEST_CASE("bodies fall asleep, and are woken, as without ranks") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            CAPTURE(static_cast<int>(grains));
            const auto run = [&](bool is_divided) {
                World world = tumbling({.grains = grains, .bodies = 60});
                auto& materials = world.resource<Materials>();
                for (Material& m : materials.list) m.rolling_friction = m.twisting_friction = 0.1;
                materials.mix();
                world.add_resource(LocalDamping{0.3});
                add_sleep(world, {.steps = 200});
                SmallSceneSettings settings = plain();
                settings.law = LawName::linear_rolling;
                Simulation simulation = begin(std::move(world), settings);
                if (!is_divided) simulation.divide({});
                simulation.advance(30'000);
                CHECK(sleepers(simulation.world()) > 20);
                // the highest of the sleepers is lifted, falls onto others and wakes them
                World& settled = simulation.world();
                const auto position = settled.column<Bodies, Position>();
                const auto highest = static_cast<Row>(
                    std::ranges::max_element(position, {}, [](const Vec3& x) { return x.z(); }) -
                    position.begin());
                position[highest].z() += 0.02;
                settled.column<Bodies, Resting>()[highest] = 0;
                invalidate_lists(settled);
                simulation.advance(4'000);
                return simulation.snapshot();
            };
            CHECK(difference(run(false), run(true)) == "");
        }
    }

    TEST_CASE("the one grain of a stiff material counts once, on whatever ranks it is a ghost") {
        const auto make = [] {
            World world = long_heap(Grains::spheres, Walls::planes, 90, 8);
            Material stiff = linear_material(6.4e6, 1e6, 0.5); // if two could touch, forces would
            const auto number = world.resource<Materials>().add(stiff); // be rounded more coarsely
            const auto position = world.column<Bodies, Position>();
            const auto run = world.column<Bodies, MaterialOf>();
            const Row middle = static_cast<Row>(
                std::ranges::min_element(position, {},
                                         [&](const Vec3& x) { return std::abs(x.x() - 0.03); }) -
                position.begin());
            run[middle] = number;
            return world;
        };
        const Archive whole = undivided(make(), plain(), 800);
        Simulation divided = begin(make(), plain());
        divided.advance(800);
        CHECK(difference(whole, divided.snapshot()) == "");
    }

    TEST_CASE("a time step that changes between steps is the same on all ranks") {
        const auto run = [&](bool divided) {
            Simulation simulation =
                begin(long_heap(Grains::spheres, Walls::facets, 90, 5), plain());
            if (!divided) simulation.divide({});
            for (const double factor : {1.0, 0.7, 1.3, 0.9}) {
                Clock& clock = simulation.world().resource<Clock>();
                clock.change_step(factor * clock.dt);
                simulation.advance(400);
            }
            return simulation.snapshot();
        };
        CHECK(difference(run(false), run(true)) == "");
    }

    TEST_CASE("threads on each rank do not change a bit") {
        const auto make = [] { return long_heap(Grains::clumps, Walls::facets, 90, 11); };
        SmallSceneSettings settings = plain();
        const Archive whole = undivided(make(), settings, 800);
        settings.threads = 2;
        settings.lists = {};
        Simulation divided = begin(make(), settings);
        divided.advance(800);
        CHECK(difference(whole, divided.snapshot()) == "");
    }

    TEST_CASE("a fault that one rank finds stops all ranks in the same step") {
        const auto make = [] {
            World world = long_heap(Grains::spheres, Walls::planes, 90, 13);
            world.resource<Limits>().speed = 0.6;
            return world;
        };
        const auto stop_of = [&](bool divided) {
            Simulation simulation = begin(make(), plain());
            if (!divided) simulation.divide({});
            return refusal_of([&] { simulation.advance(5000); });
        };
        const std::string alone = stop_of(false), together = stop_of(true);
        REQUIRE(!alone.empty());
        CHECK(alone.substr(0, alone.find(':')) == together.substr(0, together.find(':')));
    }

    TEST_CASE(
        "random scenes of extreme ratios give the same bits, or stop in the same step, on any "
        "number of ranks") {
        const char* asked = std::getenv("BRIS_RANDOM_SCENES");
        const unsigned scenes = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 200;
        unsigned done = 0, stopped = 0;
        for (unsigned k = 0; k < scenes; ++k) {
            CAPTURE(k);
            const auto run = [&](bool divided) {
                testing::ExtremeScene scene = testing::extreme_scene(k);
                Simulation simulation = begin(std::move(scene.world), scene.settings);
                if (!divided) simulation.divide({});
                const std::string text = refusal_of([&] { simulation.advance(scene.steps); });
                return std::pair(text.substr(0, text.find(':')),
                                 text.empty() ? simulation.snapshot() : Archive());
            };
            const auto [alone, whole] = run(false);
            const auto [together, parts] = run(true);
            REQUIRE(alone == together);
            REQUIRE(difference(whole, parts) == "");
            ++(alone.empty() ? done : stopped);
        }
        CHECK(done > scenes / 10);
        CHECK(stopped > scenes / 10);
    }

    TEST_CASE("forces on the elements of a membrane are added over ranks beyond 2^63 units") {
        constexpr WideInteger large = WideInteger{1} << 62;
        ElementSums rows;
        rows.elements = 2;
        constexpr auto most = static_cast<std::int64_t>(large);
        rows.rows = {{.push = most, .hold = 1},
                     {.push = -most, .hold = 2},
                     {.push = most, .hold = 3},
                     {.push = 7, .hold = 4}};
        MembraneSums sums;
        sum_membrane(rows, {}, sums);
        share_membrane_forces({}, sums);
        const auto ranks = static_cast<int>(Ranks::size());
        REQUIRE(sums.of.size() == 2);
        CHECK((sums.of[0][0] == 2 * large * ranks));
        CHECK((sums.of[1][0] == (7 - large) * ranks));
        CHECK((sums.of[1][1] == 6 * ranks));
    }

    TEST_CASE("random scenes give the same bits on any number of ranks") {
        const char* asked = std::getenv("BRIS_RANDOM_SCENES");
        const unsigned scenes = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 25;
        constexpr std::array laws{LawName::linear,
                                  LawName::linear_viscous,
                                  LawName::hertz_mindlin_viscous,
                                  LawName::linear_rolling,
                                  LawName::hertz_mindlin_rolling,
                                  LawName::linear_bridge,
                                  LawName::linear_edges,
                                  LawName::hertz_edges};
        const char* first = std::getenv("BRIS_FIRST_SCENE");
        for (unsigned k = first ? static_cast<unsigned>(std::atoi(first)) : 0; k < scenes; ++k) {
            Random draw(2026, k);
            const auto number = [&](double low, double high) {
                return low + (high - low) * draw.uniform();
            };
            const auto grains = number(0, 1) < 0.6 ? Grains::spheres : Grains::clumps;
            const auto walls = number(0, 1) < 0.5 ? Walls::planes : Walls::facets;
            const auto bodies = static_cast<unsigned>(number(8, 120));
            const double push = number(0, 1) < 0.5 ? number(20, 80) : 0;
            SmallSceneSettings settings = plain();
            settings.law = laws[static_cast<std::size_t>(number(0, 7.999))];
            settings.energy_budget = number(0, 1) < 0.3;
            settings.unlimited = true;
            settings.lists.outer_skin = number(0.0006, 0.004);
            settings.lists.inner_skin = settings.lists.outer_skin * number(0.1, 0.9);
            settings.lists.tune = number(0, 1) < 0.5;
            const auto before = static_cast<std::uint64_t>(number(30, 300));
            const bool may_sleep =
                number(0, 1) < 0.4 && walls == Walls::planes && !settings.energy_budget;
            const auto make = [&] {
                World world =
                    bed({.grains = grains, .walls = walls, .bodies = bodies, .seed = k + 1});
                if (traits(settings.law).edges) testing::add_edges(world);
                // to and fro along x, so that bodies hop over the cuts
                world.resource<Gravity>().value = Vec3(k % 2 == 0 ? push : -push, push / 3, -9.81);
                // sooner than they should, so that some sleep and are woken
                if (may_sleep) add_sleep(world, {.acceleration = 3, .speed = 0.03, .steps = 10});
                return world;
            };
            CAPTURE(k);
            const Archive whole = undivided(make(), settings, 500);
            Simulation divided = begin(make(), settings);
            divided.advance(before);
            divided.advance(500 - divided.step());
            REQUIRE(difference(whole, divided.snapshot()) == "");
        }
    }
}
