// Sensors that fail during a run, or whose samples are all rejected, must not change the motion.

#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fusion/fuse.hpp"
#include "tests/stability/observed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>

using namespace bris;

namespace {

constexpr double dt = 2e-5, interval = 1e-3;         // s
constexpr unsigned steps_each = 50;                  // per interval
constexpr unsigned good_ones = 20, all_of_them = 40; // samples of each sensor
constexpr std::array<EntityId, 2> hosts{3, 17};
constexpr EntityId another = 39; // two or three layers above the hosts

using Samples = std::vector<std::vector<TimedMeasurement>>;

Tumble bed() { return {.grains = Grains::clumps, .bodies = 40}; }

Simulation start(World world) {
    return begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
}

/// Samples of the sensors of a tumbling bed, and those that a sensor in another rock would record.
struct Recorded {
    Samples of_hosts{hosts.size()};
    std::vector<TimedMeasurement> of_another;
};

Recorded record() {
    Simulation truth = start(tumbling(bed()));
    Random random(5, 0);
    Recorded r;
    for (unsigned k = 1; k <= all_of_them; ++k) {
        truth.advance(steps_each);
        for (std::size_t s = 0; s < hosts.size(); ++s)
            r.of_hosts[s].push_back({interval * k, observed(truth, hosts[s], random)});
        r.of_another.push_back({interval * k, observed(truth, another, random)});
    }
    return r;
}

/// Samples that every filter rejects, of eight kinds in turn.
Measured refused(unsigned kind, const Measured& good, const Measured& of_another) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Measured bad; // nothing but NaN
    switch (kind % 8) {
    case 0:
        break;
    case 1:
        bad.position = bad.velocity = bad.angular_velocity = Vec3(infinite, 0, -infinite);
        break;
    case 2:
        bad.position = good.position + Vec3(1, 0, 0);
        break;
    case 3:
        bad.velocity = -1e3 * good.velocity;
        break;
    case 4:
        bad.position = Vec3::Constant(1e300);
        break;
    case 5:
        bad.attitude = Quat(0, 0, 0, 0);
        break;
    case 6:
        bad.position = of_another.position;
        break; // swapped ids
    case 7:
        bad.attitude = Quat(good.attitude * Quat(0, 1, 0, 0));
        break; // another frame
    }
    return bad;
}

/// The recordings up to the k-th sample. Then they end or, if `goes_on`, only samples that are
/// rejected follow, three times as often: some arrive while the last good correction is still being
/// applied.
Samples up_to(const Recorded& recorded, unsigned k, bool goes_on) {
    Samples samples(hosts.size());
    for (std::size_t s = 0; s < hosts.size(); ++s) {
        const auto& good = recorded.of_hosts[s];
        samples[s].assign(good.begin(), good.begin() + k);
        for (unsigned n = 0; goes_on && n < 3 * (all_of_them - k); ++n)
            samples[s].push_back({interval * (k + (n + 1) / 3.0),
                                  refused(n + static_cast<unsigned>(s), good[k + n / 3].what,
                                          recorded.of_another[k + n / 3].what)});
    }
    return samples;
}

struct Method {
    unsigned injection_steps = 40;
    NudgingSettings nudging = {};
    double largest_shift = 0;
};

Simulation with_sensors(Samples samples, const Method& method = {}) {
    World world = tumbling(bed());
    add_sensors(world, {hosts.begin(), hosts.end()}, std::move(samples),
                {.position = 1e-4,
                 .velocity = 0.1,
                 .attitude = 0.02,
                 .angular_velocity = 1,
                 .acceleration_density = 0.1,
                 .angular_acceleration_density = 1e3,
                 .gate = 0.999},
                method.injection_steps);
    auto& fusion = world.resource<Fusion>();
    fusion.nudging = method.nudging;
    fusion.largest_shift = method.largest_shift;
    return start(std::move(world));
}

/// Fingerprint of all State except that of sensors and filters; `bare`: also without the columns
/// that only sensor hosts use.
std::uint64_t mechanics(const Simulation& sim, bool bare = false) {
    constexpr std::array of_hosts{"bodies/guided", "bodies/correction", "bodies/nudging",
                                  "bodies/fusion_work"};
    const Archive all = sim.snapshot();
    Archive some;
    for (const auto& array : all.arrays()) {
        const bool of_fusion =
            array.path.starts_with("sensors/") || array.path.starts_with("fusion/");
        if (!of_fusion && !(bare && std::ranges::count(of_hosts, array.path) > 0)) some.put(array);
    }
    CHECK(some.arrays().size() > 15);
    return fingerprint(some);
}

template <class Component>
std::uint64_t counted(Simulation& sim) {
    std::uint64_t sum = 0;
    for (const auto number : sim.world().column<Sensors, Component>()) sum += number;
    return sum;
}

constexpr unsigned all_steps = steps_each * all_of_them + 1;

} // namespace

TEST_SUITE("fusion/dead_sensors") {
    TEST_CASE("if all samples after some time are rejected, clumps move as if the recordings had "
              "ended there, to the last bit") {
        const Recorded recorded = record();
        const std::array methods{Method{}, Method{.injection_steps = 1},
                                 Method{.nudging = {50, 0.02, 0.005}},
                                 Method{.largest_shift = 2e-7}};
        for (std::size_t k = 0; k < methods.size(); ++k) {
            CAPTURE(k);
            Simulation ended = with_sensors(up_to(recorded, good_ones, false), methods[k]),
                       goes_on = with_sensors(up_to(recorded, good_ones, true), methods[k]);
            for (const unsigned steps :
                 {steps_each * good_ones + 30, all_steps - steps_each * good_ones - 30}) {
                ended.advance(steps);
                goes_on.advance(steps);
                CHECK(mechanics(goes_on) == mechanics(ended));
            }
            CHECK(counted<Accepted>(ended) > hosts.size() * good_ones); // samples were assimilated
            CHECK(counted<Accepted>(goes_on) == counted<Accepted>(ended));
            CHECK(counted<Refused>(goes_on) >= counted<Refused>(ended) + 85);
            CHECK(fusion_work(ended.world()) != 0);
        }
    }

    TEST_CASE("if all samples are rejected, clumps move as without sensors, to the last bit") {
        const Recorded recorded = record();
        Simulation alone = start(tumbling(bed())), dead = with_sensors(up_to(recorded, 0, true)),
                   assimilated = with_sensors(up_to(recorded, good_ones, false));
        for (Simulation* sim : {&alone, &dead, &assimilated}) sim->advance(all_steps);
        CHECK(mechanics(dead, true) == mechanics(alone, true));
        CHECK(mechanics(assimilated, true) != mechanics(alone, true));
        CHECK(counted<Accepted>(dead) == 0);
        CHECK(counted<Refused>(dead) > 150);
        CHECK(fusion_work(dead.world()) == 0);
    }

    TEST_CASE("repeated samples move nothing and do not change the covariance") {
        const Recorded recorded = record();
        const Samples once = up_to(recorded, good_ones, false);
        Samples again = once;
        for (auto& samples : again) {
            const std::vector<TimedMeasurement> first = samples;
            for (unsigned k = 0; k < good_ones; ++k)
                samples.insert(samples.begin() + 3 * k, 2, first[k]);
        }
        Simulation ended = with_sensors(once), goes_on = with_sensors(again);
        ended.advance(all_steps);
        goes_on.advance(all_steps);
        CHECK(mechanics(goes_on) == mechanics(ended));
        CHECK(counted<Refused>(goes_on) == counted<Refused>(ended) + 2 * hosts.size() * good_ones);
        for (std::size_t s = 0; s < hosts.size(); ++s)
            CHECK(goes_on.world().resource<Fusion>().filters[s].covariance() ==
                  ended.world().resource<Fusion>().filters[s].covariance());
    }
}
