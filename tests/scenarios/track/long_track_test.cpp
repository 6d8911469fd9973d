// Bays of ballast side by side, copies of one: what they do under one load is what it does.
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/track/lay_bays.hpp"
#include "systems/output/balance.hpp"
#include "tests/quiet_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

using namespace bris;

namespace {

const BallastBox small_bay{.model = "bay", .rock_scale = 3, .porosity = 0.45};

/// A bay that was made once, for all tests.
struct SeatedBay {
    TemporaryDirectory folder;
    Common common = bris::testing::quiet_run("long_track", folder.path());
    Archive state;
    SeatedBay() {
        Simulation simulation = make_undivided_box(small_bay, common);
        BoxTestRun test(simulation, small_bay, common.seed);
        Run run(simulation, common, "bay");
        std::vector<Phase> phases = test.making_of_bed();
        phases.push_back(test.seat());
        run.go(phases);
        state = simulation.snapshot();
    }
    Simulation track(unsigned bays, OwnBays own) const {
        Simulation simulation = make_undivided_box(small_bay, common);
        simulation.restore(state);
        World& world = simulation.world();
        set_materials(world);
        lay_bays(world, bays, own, static_cast<EntityId>(world.table<Bodies>().size()));
        simulation.prepare();
        return simulation;
    }
    static const SeatedBay& once() {
        static const SeatedBay bay;
        return bay;
    }
};

/// Loads all ties (N on each half tie) within half of the steps.
void load_all(Simulation& simulation, double force, unsigned steps) {
    World& world = simulation.world();
    const Clock& clock = world.resource<Clock>();
    for (const EntityId tie : world.resource<BoxBodies>().ties)
        world.resource<Loads>().of_body[value_of<LoadOf>(world, tie) - 1].front().history = {
            .times = {clock.time(), clock.time() + 0.5 * steps * clock.dt},
            .values = {0.5 * dead_load, force}};
    simulation.advance(steps);
}

std::vector<double> heights(const Simulation& simulation) {
    const World& world = simulation.world();
    std::vector<double> z;
    for (const EntityId tie : world.resource<BoxBodies>().ties)
        z.push_back(world.column<Bodies, Position>()[row_of_body(world, tie)].z());
    return z;
}

/// State of the bodies and spheres of some bays, by id.
template <Kind K, class Id, class... Columns>
std::map<EntityId, std::vector<double>> rows_of(const World& world) {
    std::map<EntityId, std::vector<double>> rows;
    const auto id = world.column<K, Id>();
    for (Row r = 0; r < id.size(); ++r) {
        auto& numbers = rows[id[r]];
        const auto add = [&](const auto& value) {
            std::vector<double> more(sizeof value / sizeof(double));
            std::memcpy(more.data(), &value, sizeof value);
            numbers.insert(numbers.end(), more.begin(), more.end());
        };
        (add(world.column<K, Columns>()[r]), ...);
    }
    return rows;
}

} // namespace

TEST_SUITE("track/bays") {
    TEST_CASE("bays that are copies of one at rest are at rest, and under one load each does what "
              "the one does by itself") {
        constexpr unsigned steps = 1500;
        const SeatedBay& bay = SeatedBay::once();
        Simulation one = bay.track(1, {0, 1});
        const double before = heights(one).front();
        load_all(one, 40e3, steps);
        const double after = heights(one).front();
        REQUIRE(before - after > 1e-4);
        for (const unsigned bays : {2u, 3u}) {
            CAPTURE(bays);
            Simulation rest = bay.track(bays, {0, bays});
            rest.advance(300);
            CHECK(compute_balance(rest.world()).unbalanced_ratio < 2 * small_bay.rest);
            Simulation row = bay.track(bays, {0, bays});
            load_all(row, 40e3, steps);
            for (const double z : heights(row))
                CHECK(z == doctest::Approx(after).epsilon(1e-6 * (before - after)).scale(1));
        }
    }

    TEST_CASE("rocks of a mirrored bay move as those of the first, in the mirror") {
        const SeatedBay& bay = SeatedBay::once();
        Simulation track = bay.track(2, {0, 2});
        load_all(track, 40e3, 200);
        const World& world = track.world();
        const auto id = world.column<Bodies, BodyId>();
        const auto position = world.column<Bodies, Position>();
        const RowIndex row_of(id);
        const EntityId bodies =
            world.resource<BoxBodies>().ties[1] - world.resource<BoxBodies>().ties[0];
        double largest = 0;
        std::size_t pairs = 0;
        for (const auto& course : world.resource<BoxBodies>().rocks)
            for (const EntityId rock : course) {
                if (rock >= bodies) continue;
                const Vec3 &x = position[row_of[rock]], &y = position[row_of[rock + bodies]];
                const Vec3 image(2 * tie_spacing - x.x(), x.y(), x.z());
                largest = std::max(largest, (image - y).norm());
                ++pairs;
            }
        CHECK(pairs > 100);
        CHECK(largest < 1e-8);
    }

    TEST_CASE("a rank's own bays are those of the whole track, and boundaries are all there") {
        const SeatedBay& bay = SeatedBay::once();
        const Simulation whole = bay.track(5, {0, 5});
        const auto bodies_of = [](const Simulation& s) {
            return rows_of<Bodies, BodyId, Position, Orientation, AngularMomentum, Mass>(s.world());
        };
        const auto spheres_of = [](const Simulation& s) {
            return rows_of<Spheres, SphereId, LocalBall>(s.world());
        };
        const auto all_bodies = bodies_of(whole), all_spheres = spheres_of(whole);
        for (const OwnBays own : {OwnBays{0, 2}, OwnBays{1, 4}, OwnBays{3, 5}}) {
            const Simulation part = bay.track(5, own);
            const auto bodies = bodies_of(part), spheres = spheres_of(part);
            for (const auto& [id, numbers] : bodies) CHECK(all_bodies.at(id) == numbers);
            for (const auto& [id, numbers] : spheres) CHECK(all_spheres.at(id) == numbers);
            const double share = (own.last - own.first) / 5.0;
            CHECK(static_cast<double>(spheres.size()) ==
                  share * static_cast<double>(all_spheres.size()));
            CHECK(part.world().resource<BoxBodies>().ties.size() == 5);
            for (const EntityId tie : part.world().resource<BoxBodies>().ties)
                CHECK(bodies.count(tie) == 1);
            const auto key = part.world().column<SpherePairs, PairKey>();
            for (const PairNames& names : key) {
                CHECK(bodies.count(names.owner) == 1);
                CHECK(bodies.count(names.partner) == 1);
            }
        }
    }
}
