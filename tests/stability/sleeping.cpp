// S18: a bed whose grains may sleep settles as one whose grains may not, whatever changes around
// it, and no sleeping grain floats.
#include "components/sleep.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/sleep/sleep.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace bris {

namespace {

constexpr double radius = 0.01; ///< m, about that of the grains

/// A bed in a box whose floor has a host of its own.
struct Bed {
    Simulation simulation;
    EntityId floor;
    unsigned grains;

    double mean_height() {
        double sum = 0;
        for (EntityId id = 0; id < grains; ++id) sum += value_of<Position>(simulation, id).z();
        return sum / grains;
    }
    /// To be called after a change from outside.
    void wake() {
        invalidate_lists(simulation.world());
        if (simulation.world().has_resource<Sleep>()) wake_all(simulation.world());
    }
};

Bed make_bed(Grains grains, unsigned count, std::uint64_t seed, bool may_sleep) {
    const Tumble t{.grains = grains, .bodies = count, .seed = seed, .walls = false};
    World world = tumbling(t);
    auto& materials = world.resource<Materials>();
    // otherwise a sphere on one contact spins for ever
    for (Material& m : materials.list) m.rolling_friction = m.twisting_friction = 0.1;
    materials.mix();
    world.add_resource(LocalDamping{0.3});
    const EntityId floor = add_boundary(world, Vec3::Zero(), 0),
                   sides = add_boundary(world, Vec3::Zero(), 0);
    const Vec3 high = box_of(t);
    add_plane(world, floor, Vec3::Zero(), Vec3::UnitZ());
    add_plane(world, sides, Vec3::Zero(), Vec3::UnitX());
    add_plane(world, sides, Vec3::Zero(), Vec3::UnitY());
    add_plane(world, sides, high, -Vec3::UnitX());
    add_plane(world, sides, high, -Vec3::UnitY());
    if (may_sleep) add_sleep(world, {.steps = 200});
    return {begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_rolling}), floor, count};
}

/// Largest unbalanced acceleration (m/s2) of the grains that sleep, in the pose in which they
/// sleep.
double wake_and_measure(Bed& bed) {
    World& world = bed.simulation.world();
    std::vector<EntityId> asleep;
    for (EntityId id = 0; id < bed.grains; ++id)
        if (value_of<Resting>(world, id) >= world.resource<Sleep>().steps) asleep.push_back(id);
    bed.wake();
    bed.simulation.advance(1); // all contacts, and the forces on all grains
    double most = 0;
    for (const EntityId id : asleep)
        most = std::max(most, value_of<Force>(world, id).norm() / value_of<Mass>(world, id));
    return most;
}

EntityId lowest(Bed& bed) {
    EntityId found = 0;
    for (EntityId id = 1; id < bed.grains; ++id)
        if (value_of<Position>(bed.simulation, id).z() <
            value_of<Position>(bed.simulation, found).z())
            found = id;
    return found;
}

/// A change from outside, made to both beds. Where grains fall, the smallest difference decides
/// where they come to rest.
struct Change {
    const char* name;
    double bound; ///< of the difference of settlement, relative to the radius
    std::function<void(Bed&, EntityId lowest)> make;
};

const std::array changes{
    Change{"filling", 0.001, [](Bed&, EntityId) {}},
    Change{
        "a support removed", 0.05,
        [](Bed& bed, EntityId one) { value_of<Position>(bed.simulation, one).z() += 10 * radius; }},
    Change{"the floor moved down by a tenth of a radius", 0.005,
           [](Bed& bed, EntityId) {
               value_of<Position>(bed.simulation, bed.floor).z() -= 0.1 * radius;
           }},
    Change{"the floor moved up by a hundredth of a radius", 0.005,
           [](Bed& bed, EntityId) {
               value_of<Position>(bed.simulation, bed.floor).z() += 0.01 * radius;
           }},
    Change{"the weight doubled", 0.005,
           [](Bed& bed, EntityId) { bed.simulation.world().resource<Gravity>().value *= 2; }}};

void add_bed(StressRows& rows, Grains grains, const StressSettings& s) {
    const unsigned count = s.full ? 200 : 30;
    const std::uint64_t steps = s.full ? 80'000 : 25'000;
    Bed sleeping = make_bed(grains, count, s.seed, true),
        awake = make_bed(grains, count, s.seed, false);
    double height = sleeping.mean_height(), height_awake = awake.mean_height();
    for (const Change& change : changes) {
        const EntityId one = lowest(awake);
        for (Bed* bed : {&sleeping, &awake}) {
            change.make(*bed, one);
            bed->wake();
            bed->simulation.advance(steps);
        }
        const double settled = height - sleeping.mean_height(),
                     settled_awake = height_awake - awake.mean_height(),
                     difference = std::abs(settled - settled_awake) / radius;
        height -= settled;
        height_awake -= settled_awake;
        const std::size_t asleep = sleepers(sleeping.simulation.world());
        const double imbalance = wake_and_measure(sleeping) / Sleep{}.acceleration;
        awake.simulation.advance(1);
        const std::string what = fmt::format(
            "{} {}, {}", count, grains == Grains::spheres ? "spheres" : "clumps", change.name);
        rows.push_back({"S18", what + ": settlement with sleep and without",
                        fmt::format("differs by less than {} % of a radius", 100 * change.bound),
                        fmt::format("{:.4g} and {:.4g} mm, difference {:.2g} % of a radius",
                                    1e3 * settled, 1e3 * settled_awake, 100 * difference),
                        difference < change.bound});
        rows.push_back({"S18", what + ": sleeping grains carry their weight",
                        "more than half sleep, unbalanced acceleration at most 2 x the limit",
                        fmt::format("{} sleep, {:.2g} x the limit", asleep, imbalance),
                        2 * asleep > count && imbalance <= 2});
    }
}

} // namespace

StressRows stress_sleeping(const StressSettings& s) {
    StressRows rows;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) add_bed(rows, grains, s);
    return rows;
}

} // namespace bris
