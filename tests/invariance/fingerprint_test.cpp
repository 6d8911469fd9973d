#include "engine/state.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "systems/loads/rail.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/quantities.hpp"
#include "tests/edges.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <functional>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr std::uint64_t seed = 20240607; // printed with every failure

struct Scene {
    std::string name;
    std::function<World()> make;
    LawName law = LawName::linear_viscous;
    unsigned steps = 1200;
    bool energy_budget = false;
};

/// Spheres in a box, every ninth of which is driven or fixed.
World partly_driven_scene() {
    World world = bed({.bodies = 120, .seed = seed});
    const auto id = world.column<Bodies, BodyId>();
    const auto motion = world.column<Bodies, MotionOf>();
    for (Row b = 0; b < id.size(); ++b) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free) || id[b] % 9 != 0) continue;
        const bool fixed = id[b] % 18 == 0;
        motion[b] = static_cast<std::uint32_t>(fixed ? Motion::fixed : Motion::prescribed);
        if (!fixed) world.column<Bodies, DriveVelocity>()[b] = Vec3(0.01, 0, -0.02);
    }
    return world;
}

/// A membrane under pressure around grains that move in a box inside it.
World tube_scene(Grains grains, bool latex = false) {
    World world = bed({.grains = grains, .walls = Walls::planes, .bodies = 45, .seed = seed});
    const auto wall = add_material(world, {"membrane", 0, 4e5, 0, 0, 500, 0});
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

/// A tie with a harmonic load falls on clumps, one of which carries an inertial sensor; a plate on
/// springs lies under them.
World tie_scene() {
    World world = bed({.grains = Grains::clumps, .bodies = 40, .seed = seed});
    const Vec3 box = box_of({.grains = Grains::clumps, .bodies = 40});
    const EntityId plate = add_block(world, Vec3(box.x() / 2, box.y() / 2, -0.0018),
                                     Quat(Quat::Identity()), Vec3(0.03, 0.03, 0.004), 0.02, 1);
    for (const double x : {-0.01, 0.01})
        for (const double y : {-0.01, 0.01})
            add_patch(world, plate,
                      {.point = Vec3(x, y, 0),
                       .anchor = value_of<Position>(world, plate) + Vec3(x, y, 0),
                       .stiffness = 4e3,
                       .damping = 2});
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())})
        add_patch(world, plate,
                  {.anchor = value_of<Position>(world, plate),
                   .axis = axis,
                   .stiffness = 4e3,
                   .damping = 2});
    const EntityId tie =
        add_block(world, Vec3(box.x() / 2, box.y() / 2, 0.75 * box.z()),
                  exponential_map(Vec3(0.2, 0.1, 0)), Vec3(0.02, 0.035, 0.015), 0.02, 1);
    value_of<Velocity>(world, tie) = Vec3(0, 0, -2);
    add_load(world, tie,
             {.force = Vec3(0, 0, -1),
              .point = Vec3(0.002, 0.01, 0),
              .history = {.mean = 1, .amplitude = 0.8, .frequency = 100}});
    add_recorder(world, 3, imu_preset("smartrock-like"), world.resource<Gravity>().value, seed);
    start_recording(world);
    return world;
}

/// Two ties under a rail, along which an axle rolls, fall on clumps.
World rail_scene() {
    World world = bed({.grains = Grains::clumps, .bodies = 40, .seed = seed});
    const Vec3 box = box_of({.grains = Grains::clumps, .bodies = 40});
    Rail rail{.bending = 0.02,
              .pad = 4e3,
              .retardation = 1e-4,
              .weight = 1,
              .axle_positions = {0.2 * box.x()},
              .axle_loads = {1},
              .axle_speed = 2};
    for (const double x : {0.3, 0.7}) {
        rail.seats.push_back(
            {.tie =
                 add_block(world, Vec3(x * box.x(), box.y() / 2, 0.75 * box.z()),
                           exponential_map(Vec3(0.2, 0.1, 0)), Vec3(0.012, 0.035, 0.012), 0.01, 1),
             .point = Vec3(0, 0.005, 0.006)});
        value_of<Velocity>(world, rail.seats.back().tie) = Vec3(0, 0, -1);
    }
    add_rail(world, rail);
    return world;
}

const std::vector<Scene>& scenes() {
    static const std::vector<Scene> list{
        {"spheres in a box of planes", [] { return bed({.bodies = 120, .seed = seed}); }},
        {"spheres in a box of planes, some of them driven", partly_driven_scene},
        {"spheres in a box of facets",
         [] { return bed({.walls = Walls::facets, .bodies = 120, .seed = seed}); }},
        {"clumps in a box of planes",
         [] { return bed({.grains = Grains::clumps, .bodies = 48, .seed = seed}); }},
        {"clumps in a box of facets",
         [] {
             return bed(
                 {.grains = Grains::clumps, .walls = Walls::facets, .bodies = 48, .seed = seed});
         }},
        {"spheres in a membrane", [] { return tube_scene(Grains::spheres); }},
        {"clumps in a membrane", [] { return tube_scene(Grains::clumps); }},
        {"spheres in a sleeve", [] { return tube_scene(Grains::spheres, true); }},
        {"clumps in a sleeve", [] { return tube_scene(Grains::clumps, true); }},
        {"a tie and a plate among clumps, with loads, springs and a sensor", tie_scene},
        {"ties under a rail among clumps", rail_scene},
        {"locally damped clumps in a box of facets",
         [] {
             World world = bed(
                 {.grains = Grains::clumps, .walls = Walls::facets, .bodies = 48, .seed = seed});
             world.add_resource(LocalDamping{0.4});
             return world;
         },
         LawName::linear, 2000},
        {"clumps in a box of planes, whose patches share one stiffness",
         [] {
             World world = bed({.grains = Grains::clumps, .bodies = 48, .seed = seed});
             world.resource<Materials>().policy.patch = PatchStiffness::shared;
             return world;
         }},
        {"clumps in a box of facets, with an energy budget",
         [] {
             return bed(
                 {.grains = Grains::clumps, .walls = Walls::facets, .bodies = 48, .seed = seed});
         },
         LawName::linear_viscous, 1200, true},
        {"clumps in a box of facets, whose edges yield",
         [] {
             World world = bed(
                 {.grains = Grains::clumps, .walls = Walls::facets, .bodies = 48, .seed = seed});
             add_edges(world);
             return world;
         },
         LawName::hertz_edges},
        {"spheres in a membrane, whose edges yield",
         [] {
             World world = tube_scene(Grains::spheres);
             add_edges(world);
             return world;
         },
         LawName::hertz_edges},
    };
    return list;
}

// small chunks, so that few grains give many of them
const SmallSceneSettings plain{
    .dt = 2e-5,
    .lists = {.outer_skin = 0.004, .inner_skin = 0.0004, .sort_every = 8, .tune = false},
    .schedule = {.grain = 16}};

Archive state_after(const Scene& scene, SmallSceneSettings settings) {
    settings.law = scene.law;
    settings.energy_budget = scene.energy_budget;
    Simulation sim = begin(scene.make(), settings);
    sim.advance(scene.steps);
    return sim.snapshot();
}

/// The first array that differs; empty if all are equal.
std::string difference(const Archive& a, const Archive& b) {
    for (const auto& array : a.arrays()) {
        const auto* other = b.find(array.path);
        if (other == nullptr) return array.path + " is missing";
        if (array.bytes != other->bytes) return array.path + " differs";
    }
    return a.arrays().size() == b.arrays().size() ? "" : "another number of arrays";
}

} // namespace

TEST_SUITE("invariance/fingerprint") {
    TEST_CASE("threads, task graph, order, sorting and skins do not change a bit") {
        struct Variant {
            std::string name;
            SmallSceneSettings settings;
        };
        const auto with = [](auto change) {
            SmallSceneSettings s = plain;
            change(s);
            return s;
        };
        const std::vector<Variant> variants{
            {"graph, 1 thread", with([](SmallSceneSettings& s) { s.schedule.overlap = true; })},
            {"graph, 2 threads", with([](SmallSceneSettings& s) {
                 s.schedule.overlap = true;
                 s.threads = 2;
             })},
            {"graph, 3 threads", with([](SmallSceneSettings& s) {
                 s.schedule.overlap = true;
                 s.threads = 3;
             })},
            {"graph, 7 threads", with([](SmallSceneSettings& s) {
                 s.schedule.overlap = true;
                 s.threads = 7;
             })},
            {"list, 2 threads", with([](SmallSceneSettings& s) { s.threads = 2; })},
            {"each system in a separate pass",
             with([](SmallSceneSettings& s) { s.schedule.fused = false; })},
            {"no system in place of several others",
             with([](SmallSceneSettings& s) { s.schedule.combined = false; })},
            {"without any optimisation", with([](SmallSceneSettings& s) {
                 s.schedule.fused = false;
                 s.lists = {.outer_skin = 0.0010001,
                            .inner_skin = 0.001,
                            .widest_ratio = 1e9,
                            .sort_every = 0,
                            .tune = false};
             })},
            {"coarse chunks", with([](SmallSceneSettings& s) { s.schedule.grain = 1000; })},
            {"another valid order",
             with([](SmallSceneSettings& s) { s.schedule = {.last_order = true, .grain = 16}; })},
            {"never sorted", with([](SmallSceneSettings& s) { s.lists.sort_every = 0; })},
            {"sorted at every rebuild", with([](SmallSceneSettings& s) {
                 s.lists.sort_every = 1;
                 s.lists.outer_skin = 0.0012;
             })},
            {"wide skins", with([](SmallSceneSettings& s) {
                 s.lists.outer_skin = 0.008;
                 s.lists.inner_skin = 0.002;
             })},
            {"narrow skins", with([](SmallSceneSettings& s) {
                 s.lists.outer_skin = 0.0005;
                 s.lists.inner_skin = 0.0001;
             })},
            {"tuned skins", with([](SmallSceneSettings& s) { s.lists = {}; })},
            {"tuned skins from given values", with([](SmallSceneSettings& s) {
                 s.lists.tune = true;
                 s.lists.sort_every = 3;
             })},
        };
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            CAPTURE(seed);
            const Archive reference = state_after(scene, plain);
            const auto* springs = reference.find("sphere_pairs/key");
            REQUIRE(springs != nullptr);
            CHECK_MESSAGE(springs->rows() > 4, "the test needs a scene with stretched springs");
            for (const Variant& v : variants) {
                CAPTURE(v.name);
                const Archive state = state_after(scene, v.settings);
                CHECK(difference(reference, state) == "");
                CHECK(fingerprint(state) == fingerprint(reference));
            }
        }
    }

    TEST_CASE("scenes of many chunks end with the same bits on any number of threads") {
        struct Large {
            std::string name;
            Grains grains;
            Walls walls;
            unsigned bodies;
        };
        for (const Large& scene :
             {Large{"spheres in planes", Grains::spheres, Walls::planes, 4000},
              Large{"spheres in facets", Grains::spheres, Walls::facets, 4000},
              Large{"clumps in facets", Grains::clumps, Walls::facets, 2000}}) {
            CAPTURE(scene.name);
            const auto run = [&](unsigned threads) {
                SmallSceneSettings settings = plain;
                settings.law = LawName::linear_viscous;
                settings.threads = threads;
                settings.schedule = {};
                settings.lists.inner_skin = 0.002;
                Simulation sim = begin(bed({.grains = scene.grains,
                                            .walls = scene.walls,
                                            .bodies = scene.bodies,
                                            .seed = seed}),
                                       settings);
                sim.advance(2400);
                CHECK(sim.world().resource<NearIndex<SpherePairs>>().size() > 8192);
                CHECK(compute_quantities(sim.world()).contacts > 100);
                return sim.snapshot();
            };
            const Archive reference = run(1);
            for (const unsigned threads : {2u, 3u, 7u}) {
                CAPTURE(threads);
                CHECK(difference(reference, run(threads)) == "");
            }
        }
    }

    TEST_CASE("computing quantities and taking snapshots does not change a bit") {
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            const Archive reference = state_after(scene, plain);
            SmallSceneSettings settings = plain;
            settings.law = scene.law;
            settings.energy_budget = scene.energy_budget;
            Simulation sim = begin(scene.make(), settings);
            for (unsigned done = 0; done < scene.steps; done += 40) {
                sim.advance(40);
                CHECK(std::isfinite(compute_quantities(sim.world()).kinetic_energy));
                CHECK(solid_volume(sim.world(), {0.03, 0, 0.05}, 20) >= 0);
                CHECK(fingerprint(sim.snapshot()) != 0);
            }
            CHECK(difference(reference, sim.snapshot()) == "");
        }
    }

    TEST_CASE("a run restored from a snapshot of a random step ends with the same bits") {
        Random random(seed, 3);
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            const Archive reference = state_after(scene, plain);
            for (const bool fresh : {false, true}) {
                const auto at = static_cast<unsigned>(random.uniform(0.1, 0.9) * scene.steps);
                CAPTURE(at);
                CAPTURE(fresh);
                SmallSceneSettings settings = plain;
                settings.law = scene.law;
                settings.energy_budget = scene.energy_budget;
                Simulation sim = begin(scene.make(), settings);
                sim.advance(at);
                const Archive saved = sim.snapshot();
                settings.lists = {}; // other skins in the continued run
                settings.threads = 2;
                settings.schedule.overlap = true;
                Simulation other = begin(scene.make(), settings);
                Simulation& next = fresh ? other : sim;
                if (!fresh) sim.advance(37); // some steps that are then undone
                next.restore(saved);
                CHECK(difference(saved, next.snapshot()) == "");
                next.advance(scene.steps - at);
                CHECK(difference(reference, next.snapshot()) == "");
            }
        }
    }

    TEST_CASE("discarding the lists between steps does not change a bit, nor where the time step "
              "changes") {
        const Scene& scene = scenes()[3];
        const auto run = [&](bool discard) {
            SmallSceneSettings settings = plain;
            settings.law = scene.law;
            settings.energy_budget = scene.energy_budget;
            Simulation sim = begin(scene.make(), settings);
            Random random(seed, 4);
            for (unsigned step = 0; step < scene.steps; ++step) {
                const double chance = random.uniform();
                if (chance < 0.02) { // the contacts of the next step predict velocities with it
                    Clock& clock = sim.world().resource<Clock>();
                    clock.change_step(clock.dt * (chance < 0.01 ? 1.1 : 1 / 1.1));
                }
                if (discard && (chance < 0.02 || chance > 0.95)) invalidate_lists(sim.world());
                sim.advance();
            }
            return sim.snapshot();
        };
        CHECK(difference(run(false), run(true)) == "");
    }
}
