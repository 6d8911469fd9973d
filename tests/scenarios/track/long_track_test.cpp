// Bays of ballast side by side, copies of one: what they do under one load is what it does.
#include "components/boundary.hpp"
#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/passages.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/track/lay_bays.hpp"
#include "scenarios/track/rail_over_bays.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/loads/rail.hpp"
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
const BallastBox bay_of_mud{.run = "II.3",
                            .model = "bay",
                            .rock_scale = 3,
                            .porosity = 0.45,
                            .fouling = {.kind = "clay", .settings = {.voxel = 0.04}}};

/// A bay that was made once, for all tests.
struct SeatedBay {
    const BallastBox box;
    TemporaryDirectory folder;
    Common common = bris::testing::quiet_run("long_track", folder.path());
    Archive state;
    explicit SeatedBay(const BallastBox& of) : box(of) {
        Simulation simulation = make_undivided_box(box, common);
        BoxTestRun test(simulation, box, common.seed);
        Run run(simulation, common, "bay");
        run.go(test.bed_of_track());
        state = simulation.snapshot();
    }
    Simulation bay() const {
        Simulation simulation = make_undivided_box(box, common);
        if (fouling_of(box).any()) add_fields(simulation, box);
        simulation.restore(state);
        set_materials(simulation.world(), {.friction = friction_of_stones(simulation.world())});
        return simulation;
    }
    Simulation track(unsigned bays, OwnBays own) const {
        Simulation simulation = bay();
        World& world = simulation.world();
        if (world.has_resource<Fouling>()) fix_fouling(world);
        lay_bays(world, bays, own, static_cast<EntityId>(world.table<Bodies>().size()));
        simulation.prepare();
        return simulation;
    }
    static const SeatedBay& once() {
        static const SeatedBay bay(small_bay);
        return bay;
    }
    static const SeatedBay& of_mud() {
        static const SeatedBay bay(bay_of_mud);
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

    TEST_CASE("bays of mud are copies with the fines around each rock, which stay there, and do "
              "what the one does by itself with its fields") {
        constexpr unsigned steps = 1500;
        const SeatedBay& mud = SeatedBay::of_mud();
        Simulation alone = mud.bay();
        alone.world().resource<Fouling>().settings.refresh = 1e6; // voxels
        const double before = heights(alone).front();
        load_all(alone, 40e3, steps);
        const double deflection = before - heights(alone).front();
        REQUIRE(deflection > 1e-4);
        Simulation row = mud.track(3, {0, 3});
        load_all(row, 40e3, steps);
        for (const double z : heights(row))
            CHECK(before - z == doctest::Approx(deflection).epsilon(1e-6));

        const World& world = row.world();
        const auto id = world.column<Bodies, BodyId>();
        const auto around = world.column<Bodies, FoulingAround>();
        const RowIndex row_of(id);
        const EntityId bodies =
            world.resource<BoxBodies>().ties[1] - world.resource<BoxBodies>().ties[0];
        double largest = 0;
        for (Row b = 0; b < id.size(); ++b) {
            largest = std::max(largest, around[b].contaminant);
            if (id[b] < bodies || row_of[id[b] % bodies] == no_row) continue;
            CHECK(around[b].contaminant == around[row_of[id[b] % bodies]].contaminant);
            CHECK(around[b].saturation == around[row_of[id[b] % bodies]].saturation);
        }
        CHECK(largest > 0.3);
        CHECK_FALSE(world.resource<Materials>().weakened().empty());
        CHECK_FALSE(has_fouling_fields(world));
        // its plates are gone, so that ids are missing
        const FieldSet fields = fields_of(world, {.voxel = 0.04}),
                       of_one = fields_of(std::as_const(alone).world(), {.voxel = 0.04});
        CHECK(fields.solids.value == doctest::Approx(3 * of_one.solids.value).epsilon(1e-3));
        CHECK(fields.find("fouling") == nullptr);
        CHECK(of_one.find("fouling") != nullptr);
    }

    TEST_CASE(
        "water and fines are in a bed that is mixed with them, and come to all others in use, "
        "so that a bed without fines serves all runs") {
        const TemporaryDirectory folder;
        const Common common = bris::testing::quiet_run("long_track", folder.path());
        const auto phases = [&](const char* run, const char* fines) {
            BallastBox box = small_bay;
            box.run = run;
            box.fines = fines;
            Simulation simulation = make_undivided_box(box, common);
            const BoxTestRun test(simulation, box, common.seed);
            return std::pair{test.bed_of_track().size() - test.making_of_bed().size(),
                             test.changes_in_use().size()};
        };
        using Counts = std::pair<std::size_t, std::size_t>; // with the bed, in use
        CHECK(phases("I.2", "mixed") == Counts{1, 0});
        CHECK(phases("I.4", "mixed") == Counts{1, 2}); // wet, without shoulder
        CHECK(phases("II.3", "mixed") == Counts{2, 0});
        CHECK(phases("II.4", "mixed") == Counts{2, 1});
        CHECK(phases("II.3", "filled") == Counts{1, 1});
        CHECK(SeatedBay::of_mud().bay().world().resource<BoxState>().wet == 1);
        CHECK(SeatedBay::once().bay().world().resource<BoxState>().wet == 0);
    }

    TEST_CASE("ties that hang on the rail rest above the ballast by the gap, carried by the rail, "
              "until a load closes it") {
        constexpr double gap = 1e-3;
        const BallastBox& box = SeatedBay::once().box;
        Simulation simulation = SeatedBay::once().bay();
        World& world = simulation.world();
        const RailOnTies rails = rails_on(box, 120e6, usual_bed);
        const double level = heights(simulation).front();
        const EntityId once = add_ties_on_springs(world, rails, 2);
        lay_bays(world, 2, {0, 2}, once);
        lay_rail(world, rails, once);
        hang_ties(world, gap);
        simulation.prepare();
        const auto of_rail = [&](EntityId tie) {
            return value_of<RailForce>(simulation.world(), tie).force.z();
        };
        const auto& ties = world.resource<BoxBodies>().ties;
        const double weight = 9.81 * value_of<Mass>(world, ties[0]) + 0.5 * dead_load;
        for (unsigned k = 0; k < 10; ++k) {
            simulation.advance(200);
            for (const double z : heights(simulation))
                CHECK(z - level == doctest::Approx(gap).epsilon(0.03));
        }
        CHECK(of_rail(ties[0]) == doctest::Approx(weight).epsilon(0.05)); // rocks hold its sides
        // nothing else moves: the ties beside them carry their own weight and a part of the load
        double sum = 0;
        for (const RailSeat& seat : world.resource<Rails>().list.front().seats)
            sum += of_rail(seat.tie);
        CHECK(std::abs(sum) < 0.02 * weight);
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
