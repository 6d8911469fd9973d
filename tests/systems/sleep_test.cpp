#include "engine/errors.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/output/quantities.hpp"
#include "systems/sleep/sleep.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <span>

using namespace bris;

namespace {

constexpr unsigned count = 60;

/// Grains that fall into a box, tumble and come to rest.
Simulation tumbling(Grains grains, bool may_sleep, SmallSceneSettings run = {},
                    unsigned bodies = count) {
    run.dt = 2e-5;
    run.law = LawName::linear_rolling; // otherwise a sphere on one contact spins for ever
    World world = bris::tumbling({.grains = grains, .bodies = bodies});
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) m.rolling_friction = m.twisting_friction = 0.1;
    materials.mix();
    world.add_resource(LocalDamping{0.3});
    if (may_sleep) add_sleep(world, {.steps = 200});
    Simulation sim = begin(std::move(world), run);
    return sim;
}

enum class Which { highest, lowest };

/// Lifts a grain: the highest then falls on sleeping grains, and the lowest no longer supports
/// those above it.
EntityId lift_one(Simulation& sim, double up = 0.02, Which which = Which::highest) {
    World& world = sim.world();
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    Row one = no_row;
    for (Row b = 0; b < position.size(); ++b)
        if (motion[b] == static_cast<std::uint32_t>(Motion::free) &&
            (one == no_row || (position[b].z() > position[one].z()) == (which == Which::highest)))
            one = b;
    const EntityId id = world.column<Bodies, BodyId>()[one];
    position[one].z() += up;
    if (world.table<Bodies>().has<Resting>()) world.column<Bodies, Resting>()[one] = 0;
    invalidate_lists(world);
    return id;
}

/// No body is awake or near one that is, so only steps that are observed compute contacts.
bool idle(const World& world) {
    const auto& busy = world.resource<Sleep>().busy;
    return !busy.empty() && std::ranges::all_of(busy, [](std::uint8_t b) { return b == 0; });
}

} // namespace

TEST_SUITE("sleep") {
    TEST_CASE("grains at rest fall asleep and are no longer computed, and their forces are those "
              "of a run without sleep") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            Simulation sim = tumbling(grains, true), waking = tumbling(grains, false);
            CHECK(sleepers(sim.world()) == 0);
            unsigned blocks = 0;
            while (!idle(sim.world()) && blocks < 400) {
                sim.advance(250);
                ++blocks;
            }
            CAPTURE(blocks);
            REQUIRE(idle(sim.world()));
            CHECK(sleepers(sim.world()) == count);
            const auto awake = sim.world().resource<NearIndex<SpherePairs>>().awake;
            CHECK(std::ranges::all_of(awake, [](std::uint8_t bits) { return bits == 0; }));
            waking.advance(blocks * 250);
            const Quantities asleep = compute_quantities(sim.world()),
                             full = compute_quantities(waking.world());
            CHECK(asleep.kinetic_energy == 0);
            CHECK(std::abs(asleep.boundary_force_over_weight() - 1) < 0.01);
            // an unbalanced acceleration below the limit may still move a grain a little
            CHECK(static_cast<double>(asleep.contacts) ==
                  about(static_cast<double>(full.contacts)).epsilon(0.01));
            CHECK(asleep.mean_overlap == about(full.mean_overlap).epsilon(0.01));
            CHECK(asleep.elastic_energy == about(full.elastic_energy).epsilon(0.02));
            double farthest = 0;
            for (EntityId id = 0; id < count; ++id)
                farthest =
                    std::max(farthest,
                             (value_of<Position>(sim, id) - value_of<Position>(waking, id)).norm());
            CHECK(farthest < 0.01 * 0.0075); // of the smallest radius
            // a state at rest does not change
            const auto before = fingerprint(sim.snapshot(), "bodies/position");
            sim.advance(500);
            CHECK(fingerprint(sim.snapshot(), "bodies/position") == before);
            CHECK(compute_quantities(sim.world()).elastic_energy == asleep.elastic_energy);
        }
    }

    TEST_CASE(
        "a grain that is hit wakes, wakes the grains that it pushes, and all fall asleep again") {
        Simulation sim = tumbling(Grains::spheres, true);
        for (unsigned k = 0; k < 400 && !idle(sim.world()); ++k) sim.advance(250);
        REQUIRE(sleepers(sim.world()) == count);
        const EntityId lifted = lift_one(sim);
        std::size_t least = count;
        for (unsigned k = 0; k < 1000 && (k < 20 || !idle(sim.world())); ++k) {
            sim.advance(100);
            least = std::min(least, sleepers(sim.world()));
        }
        CHECK(least < count - 2);
        CHECK(sleepers(sim.world()) == count);
        CHECK(value_of<Position>(sim, lifted).z() > 0.005);
        const Quantities q = compute_quantities(sim.world());
        CHECK(std::abs(q.boundary_force_over_weight() - 1) < 0.01);
        CHECK(q.largest_overlap < 0.01);
        // after a change from outside all bodies are awake
        wake_all(sim.world());
        sim.advance(1);
        CHECK(sleepers(sim.world()) == 0);
        CHECK_FALSE(idle(sim.world()));
    }

    TEST_CASE("the unbalanced acceleration of a sleeping grain is at most twice the limit for "
              "falling asleep") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            Simulation sim = tumbling(grains, true);
            for (unsigned k = 0; k < 400 && !idle(sim.world()); ++k) sim.advance(250);
            REQUIRE(sleepers(sim.world()) == count);
            wake_all(sim.world());
            sim.advance(1); // all contacts and forces of the bodies in the pose in which they slept
            const World& world = sim.world();
            const auto force = world.column<Bodies, Force>();
            const auto mass = world.column<Bodies, Mass>();
            const auto motion = world.column<Bodies, MotionOf>();
            double most = 0;
            for (Row b = 0; b < mass.size(); ++b)
                if (motion[b] == static_cast<std::uint32_t>(Motion::free))
                    most = std::max(most, force[b].norm() / mass[b]);
            CHECK(most <= 2 * Sleep{}.acceleration);
            CHECK(most > 0.01 * Sleep{}.acceleration); // otherwise the check above would be trivial
        }
    }

    TEST_CASE("grains that lose their support wake and fall") {
        Simulation sim = tumbling(Grains::spheres, true);
        for (unsigned k = 0; k < 400 && !idle(sim.world()); ++k) sim.advance(250);
        REQUIRE(sleepers(sim.world()) == count);
        const auto height = [&] {
            double sum = 0;
            for (EntityId id = 0; id < count; ++id) sum += value_of<Position>(sim, id).z();
            return sum / count;
        };
        const EntityId gone = lift_one(sim, 0.2, Which::lowest);
        const double before = height() - value_of<Position>(sim, gone).z() / count;
        std::size_t least = count;
        for (unsigned k = 0; k < 20; ++k) {
            sim.advance(50); // it takes 0.2 s to come down again
            least = std::min(least, sleepers(sim.world()));
        }
        CHECK(least < count - 2);
        CHECK(height() - value_of<Position>(sim, gone).z() / count < before);
        for (unsigned k = 0; k < 1000 && !idle(sim.world()); ++k) sim.advance(100);
        CHECK(sleepers(sim.world()) == count);
        const Quantities q = compute_quantities(sim.world());
        CHECK(std::abs(q.boundary_force_over_weight() - 1) < 0.01);
    }

    TEST_CASE("sleeping gives the same bits on any number of threads, in any order of rows, with "
              "any lists and after a restart") {
        constexpr unsigned many = 300; // enough for idle blocks of rows beside others
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            const auto settled = [&](const SmallSceneSettings& settings) {
                Simulation sim = tumbling(grains, true, settings, many);
                sim.advance(18000);
                (void)lift_one(sim, 2e-4);
                sim.advance(400);
                return sim;
            };
            Simulation sim = settled({});
            const Archive middle = sim.snapshot();
            std::size_t some = 0, least = many, most = 0;
            for (unsigned k = 0; k < 30; ++k) {
                sim.advance(50);
                const std::size_t now = sleepers(sim.world());
                least = std::min(least, now);
                most = std::max(most, now);
                std::size_t idle_blocks = 0;
                const std::span<const std::uint8_t> busy = sim.world().resource<Sleep>().busy;
                for (std::size_t first = 0; first < many; first += Table::idle_rows)
                    idle_blocks +=
                        std::ranges::all_of(
                            busy.subspan(first, std::min(Table::idle_rows, many - first)),
                            [](std::uint8_t b) { return b == 0; })
                            ? 1u
                            : 0u;
                some += idle_blocks > 0 && idle_blocks * Table::idle_rows < many ? 1u : 0u;
            }
            CAPTURE(least);
            CAPTURE(most);
            CAPTURE(some);
            CHECK(most > least); // a grain falls asleep or wakes
            CHECK(most > many / 4);
            if (grains == Grains::spheres) CHECK(some > 0);
            const auto whole = fingerprint(sim.snapshot());
            const auto run = [&](const SmallSceneSettings& settings) {
                Simulation other = settled(settings);
                other.advance(1500);
                return fingerprint(other.snapshot());
            };
            CHECK(run({.threads = 2, .schedule = {.grain = 16}}) == whole);
            CHECK(run({.threads = 3, .schedule = {.last_order = true, .grain = 8}}) == whole);
            CHECK(run({.lists = {.sort_every = 0}}) == whole);
            CHECK(run({.lists = {.sort_every = 1}}) == whole);
            CHECK(run({.lists = {.outer_skin = 0.004, .inner_skin = 0.0004, .tune = false}}) ==
                  whole);
            CHECK(run({.lists = {.outer_skin = 0.001, .inner_skin = 0.0001, .tune = false}}) ==
                  whole);
            Simulation again = tumbling(grains, true, {}, many);
            for (const int used : {0, 1}) { // a new simulation, and one that has run
                CAPTURE(used);
                again.restore(middle);
                again.advance(1500);
                CHECK(fingerprint(again.snapshot()) == whole);
            }
        }
    }

    TEST_CASE("a scene without sleep has no systems of sleep, and a scene that does not allow "
              "sleep is refused") {
        CHECK(tumbling(Grains::spheres, false).schedule().explain().find("hold_spheres: absent") !=
              std::string::npos);
        const auto refusal = [](auto&& change) {
            World world = tumbling({.grains = Grains::spheres, .bodies = 3});
            Sleep settings;
            change(world, settings);
            return message_of<InputError>([&] { add_sleep(world, settings); });
        };
        CHECK(refusal([](World&, Sleep& s) {
                  s.speed = 0;
              }).find("sleep: expected an acceleration") == 0);
        CHECK(refusal([](World& w, Sleep&) {
                  (void)add_facet_floor(w, -1, 1, 1, 0);
              }).find("sleep: expected planes") == 0);
        CHECK(refusal([](World& w, Sleep&) {
                  (void)add_boundary(w, Vec3::Zero(), 0, Motion::prescribed);
              }).find("sleep: expected fixed boundaries") == 0);
        CHECK(refusal([](World& w, Sleep&) {
                  value_of<AngularVelocity>(w, add_boundary(w, Vec3::Zero(), 0, Motion::fixed)) =
                      Vec3(0, 0, 1);
              }).find("sleep: expected fixed bodies with velocities of 0") == 0);
        CHECK(refusal([](World& w, Sleep&) {
                  w.table<Bodies>().add<BoundaryWork>();
              }).find("sleep: expected no energy budget") == 0);
    }
}
