#include "systems/fusion/fuse.hpp"

#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/world.hpp"
#include "systems/fusion/correct.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace bris {

namespace {

double end_of_step(const Clock& clock) { return clock.time() + clock.dt; }
// times are sums of steps: a sample within a millionth of a step of its end has been taken
bool is_taken(double sample, const Fusion& fusion, const Clock& clock) {
    return fusion.by_strain ? sample <= fusion.strain * (1 + 1e-9) : sample <= end_of_step(clock) + 1e-6 * clock.dt;
}

Vec3 momentum_of(double inertia, const Vec3& spin) { return inertia * spin; }
Vec3 momentum_of(const Vec3& inertia, const Quat& q, const Vec3& spin) { return q * Vec3(inertia.cwiseProduct(q.conjugate() * spin)); }

template <class BodyRows> Row row_of(const BodyRows& bodies, EntityId body) {
    const EntityId* id = bodies.template column<BodyId>();
    return static_cast<Row>(std::find(id, id + bodies.size(), body) - id);
}

void add_to(Analysis& sum, const Analysis& more) {
    sum.shift += more.shift;
    sum.velocity += more.velocity;
    sum.turn += more.turn; // small ones
    sum.spin += more.spin;
    sum.accepted += more.accepted;
    sum.refused += more.refused;
    sum.largest_distance = std::max(sum.largest_distance, more.largest_distance);
}

Vec3 at_most(const Vec3& v, double largest) { return v.norm() > largest ? Vec3(largest / v.norm() * v) : v; }

PullRow pull_for(const Analysis& wanted, const PullSettings& s) {
    return {at_most(s.stiffness * wanted.shift, s.largest_force), at_most(s.stiffness * s.arm * s.arm * wanted.turn, s.largest_force * s.arm)};
}

/// Where the body would be at a time of the past step, corrections to come included.
RigidState state_at(double earlier, const RigidState& now, const Analysis& to_come) {
    RigidState s = now;
    s.velocity += to_come.velocity;
    s.spin += to_come.spin;
    s.position += to_come.shift - earlier * s.velocity;
    s.orientation = exponential_map(to_come.turn - earlier * s.spin) * now.orientation;
    return s;
}

template <class BodyRows, class OrientationOf, class MomentumOf>
void fuse(FusedSensors sensors, const BodyRows& bodies, Fusion& fusion, const Replay& replay, const Clock& clock, OrientationOf&& orientation_of,
          MomentumOf&& momentum) {
    for (Row s = sensors.first(); s < sensors.last(); ++s) {
        std::uint64_t& next = sensors.column<NextSample>()[s];
        const auto& samples = replay.samples[s];
        if (next >= samples.size() || !is_taken(samples[next].time, fusion, clock)) continue;
        const Row b = row_of(bodies, sensors.column<SensorHost>()[s]);
        Vec3 &velocity = bodies.template column<Velocity>()[b], &spin = bodies.template column<Spin>()[b];
        CorrectionRow& correction = bodies.template column<Correction>()[b];
        const RigidState now{bodies.template column<Position>()[b], velocity + 0.5 * clock.dt * bodies.template column<Acceleration>()[b], orientation_of(b), spin};
        Analysis to_come{.shift = correction.steps * correction.shift, .turn = correction.steps * correction.turn};
        for (; next < samples.size() && is_taken(samples[next].time, fusion, clock); ++next) {
            const double time = samples[next].time, earlier = fusion.by_strain ? 0 : end_of_step(clock) - time;
            add_to(to_come, fusion.filters[s].analyse({time, state_at(earlier, now, to_come)}, samples[next].what));
        }
        const Vec3 &dv = to_come.velocity, &dw = to_come.spin, dL = momentum(b, dw);
        bodies.template column<FusionWork>()[b] += bodies.template column<InertialMass>()[b] * dv.dot(now.velocity + 0.5 * dv) + dL.dot(now.spin + 0.5 * dw);
        velocity += dv;
        spin += dw;
        bodies.template column<StepSpin>()[b] += dw;
        bodies.template column<AngularMomentum>()[b] += dL;
        std::uint32_t& guided = bodies.template column<Guided>()[b];
        if (fusion.pull.stiffness > 0) {
            bodies.template column<Pull>()[b] = pull_for(to_come, fusion.pull);
            guided = 1;
        } else {
            give_correction(correction, guided, to_come.shift, to_come.turn, fusion.injection_steps);
        }
        sensors.column<Accepted>()[s] += to_come.accepted;
        sensors.column<Refused>()[s] += to_come.refused;
        double& largest = sensors.column<LargestInnovation>()[s];
        largest = std::max(largest, to_come.largest_distance);
    }
}

} // namespace

void Fusion::save(Archive& archive) const {
    put_fields(archive, "fusion/strain", std::tie(strain));
    for (std::size_t k = 0; k < filters.size(); ++k) filters[k].save(archive, fmt::format("fusion/{}", k));
}

void Fusion::load(const Archive& archive) {
    get_fields(archive, "fusion/strain", std::tie(strain));
    for (std::size_t k = 0; k < filters.size(); ++k) filters[k].load(archive, fmt::format("fusion/{}", k));
}

void add_sensors(World& world, const std::vector<EntityId>& hosts, std::vector<std::vector<TimedMeasurement>> samples, const FilterSettings& settings,
                 unsigned injection_steps) {
    require(hosts.size() == samples.size(), fmt::format("sensors: expected a recording for each of {} hosts, found {}", hosts.size(), samples.size()));
    require(std::set(hosts.begin(), hosts.end()).size() == hosts.size(), "sensors: expected one for each host, found two");
    require(injection_steps > 0, "sensors: expected one step or more for a correction, found 0");
    Table& table = world.table<Sensors>();
    table.add<SensorId>();
    table.add<SensorHost>();
    table.add<NextSample>();
    table.add<Accepted>();
    table.add<Refused>();
    table.add<LargestInnovation>();
    table.resize(hosts.size());
    for (Row s = 0; s < hosts.size(); ++s) {
        const bool in_order = std::ranges::is_sorted(samples[s], {}, &TimedMeasurement::time);
        require(in_order, fmt::format("sensor {}: expected samples in the order of time", s));
        table.column<SensorId>()[s] = s;
        table.column<SensorHost>()[s] = hosts[s];
    }
    world.table<Bodies>().add<Guided>();
    world.table<Bodies>().add<Correction>();
    world.table<Bodies>().add<Pull>();
    world.table<Bodies>().add<FusionWork>();
    world.add_resource(Replay{std::move(samples)});
    auto& fusion = world.add_resource<Fusion>();
    fusion.filters.assign(hosts.size(), SensorFilter(settings));
    fusion.injection_steps = injection_steps;
}

bool fusion_is_due(const World& world) {
    const auto& samples = world.resource<Replay>().samples;
    const Fusion& fusion = world.resource<Fusion>();
    const Clock& clock = world.resource<Clock>();
    const auto next = world.column<Sensors, NextSample>();
    for (std::size_t s = 0; s < samples.size(); ++s)
        if (next[s] < samples[s].size() && is_taken(samples[s][next[s]].time, fusion, clock)) return true;
    return false;
}

void fuse_spheres(FusedSensors sensors, FusedBodies<const SphereInertia> bodies, Fusion& fusion, const Replay& replay, const Clock& clock) {
    const double* inertia = bodies.column<SphereInertia>();
    fuse(sensors, bodies, fusion, replay, clock, [](Row) { return Quat::Identity(); }, [&](Row b, const Vec3& spin) { return momentum_of(inertia[b], spin); });
}

void fuse_clumps(FusedSensors sensors, FusedBodies<const Orientation, const InertialInertia> bodies, Fusion& fusion, const Replay& replay, const Clock& clock) {
    const Quat* orientation = bodies.column<Orientation>();
    const Vec3* inertia = bodies.column<InertialInertia>();
    fuse(sensors, bodies, fusion, replay, clock, [&](Row b) { return orientation[b]; },
         [&](Row b, const Vec3& spin) { return momentum_of(inertia[b], orientation[b], spin); });
}

double fusion_work(const World& world) {
    return sum_by_id(rows_by_id(world.column<Bodies, BodyId>()), world.column<Bodies, FusionWork>());
}

} // namespace bris
