#include "systems/fusion/fuse.hpp"

#include "engine/errors.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "engine/system.hpp"
#include "engine/world.hpp"
#include "systems/fusion/correct.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace bris {

namespace {

/// Smallest fraction to which a correction is reduced. One that would have to be reduced further
/// has no meaning for this model and is withheld.
constexpr double least_share = 0.01;

double end_of_step(const Clock& clock) { return clock.time() + clock.dt; }
double now_of(const Fusion& fusion, const Clock& clock) {
    return fusion.by_strain ? fusion.strain : end_of_step(clock);
}
// times are sums of steps, so a sample has arrived if it is at most a millionth of a step past the
// end of the step
bool has_arrived(double time, const Fusion& fusion, const Clock& clock) {
    return fusion.by_strain ? time <= fusion.strain * (1 + 1e-9)
                            : time <= end_of_step(clock) + 1e-6 * clock.dt;
}

Vec3 momentum_of(double inertia, const Vec3& angular_velocity) {
    return inertia * angular_velocity;
}
Vec3 momentum_of(const Vec3& inertia, const Quat& q, const Vec3& angular_velocity) {
    return q * Vec3(inertia.cwiseProduct(q.conjugate() * angular_velocity));
}

template <class BodyRows>
Row row_of(const BodyRows& bodies, EntityId body) {
    const EntityId* id = bodies.template column<BodyId>();
    return static_cast<Row>(std::find(id, id + bodies.size(), body) - id);
}

// rotation vectors may be added because they are small
Analysis sum_of(const Analysis& a, const Analysis& b) {
    return {a.shift + b.shift,
            a.velocity + b.velocity,
            a.turn + b.turn,
            a.angular_velocity + b.angular_velocity,
            a.accepted + b.accepted,
            a.refused + b.refused,
            std::max(a.largest_distance, b.largest_distance)};
}

Analysis scaled(double share, const Analysis& a) {
    return {.shift = share * a.shift,
            .velocity = share * a.velocity,
            .turn = share * a.turn,
            .angular_velocity = share * a.angular_velocity};
}

/// Target to which a body is nudged. In a staged test the target is at rest.
NudgingTarget target_of(const RigidState& now, const Analysis& wanted, const Fusion& fusion) {
    NudgingTarget t{now.position + wanted.shift, Vec3::Zero(),
                    exponential_map(wanted.turn) * now.orientation, Vec3::Zero()};
    if (fusion.by_strain) return t;
    t.velocity = now.velocity + wanted.velocity;
    t.angular_velocity = now.angular_velocity + wanted.angular_velocity;
    return t;
}

/// State of the body at a time within the past step (`earlier`: s before its end), pending
/// corrections included.
RigidState state_at(double earlier, const RigidState& now, const Analysis& to_come) {
    RigidState s = now;
    s.velocity += to_come.velocity;
    s.angular_velocity += to_come.angular_velocity;
    s.position += to_come.shift - earlier * s.velocity;
    s.orientation = exponential_map(to_come.turn - earlier * s.angular_velocity) * now.orientation;
    return s;
}

bool is_same(const auto& a, const auto& b) { return a == b || (!a.allFinite() && !b.allFinite()); }
bool is_same(const Measured& a, const Measured& b) {
    return is_same(a.position, b.position) && is_same(a.velocity, b.velocity) &&
           is_same(a.angular_velocity, b.angular_velocity) && is_same(a.up, b.up) &&
           is_same(a.attitude.coeffs(), b.attitude.coeffs());
}

/// Marks samples that repeat an earlier one, which contain no new information.
void mark_repeated(std::vector<TimedMeasurement>& samples) {
    std::map<double, std::vector<std::size_t>> at_time;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        auto& before = at_time[samples[k].time];
        samples[k].again = std::ranges::any_of(
            before, [&](std::size_t j) { return is_same(samples[j].what, samples[k].what); });
        before.push_back(k);
    }
}

/// Measurement to assimilate. At the end of a stage all bodies are at rest, so zero velocities are
/// part of the measurement; they are assimilated only together with a vector of the sensor itself
/// that the gate accepts.
template <class Update>
Measured observation_of(const Measured& what, const Fusion& fusion, Update&& update) {
    if (!fusion.by_strain) return what;
    Measured own = what;
    own.velocity = own.angular_velocity = Measured().velocity;
    const Analysis assimilated = update(own);
    return own.is_empty() || (assimilated.accepted == 0 && assimilated.refused > 0) ? own : what;
}

/// Assimilates the samples of a sensor that have arrived and adds their corrections to `to_come`.
/// Returns false if no sample arrived, or all that did were repetitions.
bool assimilate_samples(SensorFilter& filter, const std::vector<TimedMeasurement>& samples,
                        std::uint64_t& next, const RigidState& now, Analysis& to_come,
                        const Fusion& fusion, const Clock& clock) {
    bool taken = false;
    for (; next < samples.size() && has_arrived(samples[next].time, fusion, clock); ++next) {
        const TimedMeasurement& m = samples[next];
        if (m.again) {
            ++to_come.refused;
            continue;
        }
        const double earlier = fusion.by_strain ? 0 : end_of_step(clock) - m.time;
        const BodyForecast forecast{m.time, state_at(earlier, now, to_come)};
        const Measured what = observation_of(m.what, fusion, [&](const Measured& own) {
            return SensorFilter(filter).update(forecast, own);
        });
        to_come = sum_of(to_come, filter.update(forecast, what));
        taken = true;
    }
    return taken;
}

RigidState state_of(const Vec3& position, const Vec3& velocity, const Vec3& acceleration,
                    const Quat& orientation, const Vec3& angular_velocity, const Clock& clock) {
    return {position, velocity + 0.5 * clock.dt * acceleration, orientation, angular_velocity};
}
Analysis pending_of(const CorrectionRow& c) {
    return {.shift = c.steps * c.shift, .turn = c.steps * c.turn};
}

/// True if the gate accepts a sample of sensor `s` that has arrived, given the present state of its
/// body.
bool is_assimilated(const World& world, Row s) {
    const Fusion& fusion = world.resource<Fusion>();
    const Clock& clock = world.resource<Clock>();
    const Table& bodies = world.table<Bodies>();
    const Row b = rows_by_id(bodies.column<BodyId>())[world.column<Sensors, SensorHost>()[s]];
    Quat orientation = Quat::Identity();
    if (bodies.has<Orientation>()) orientation = bodies.column<Orientation>()[b];
    const RigidState now = state_of(bodies.column<Position>()[b], bodies.column<Velocity>()[b],
                                    bodies.column<Acceleration>()[b], orientation,
                                    bodies.column<AngularVelocity>()[b], clock);
    Analysis to_come = pending_of(bodies.column<Correction>()[b]);
    SensorFilter filter = fusion.filters[s];
    std::uint64_t next = world.column<Sensors, NextSample>()[s];
    (void)assimilate_samples(filter, world.resource<Replay>().samples[s], next, now, to_come,
                             fusion, clock);
    return to_come.accepted > 0;
}

/// Fraction of a correction that is within the limit of a step; 0 if it would be below least_share.
double share_in_step(const Analysis& wanted, double radius, const Fusion& fusion,
                     const Clock& clock) {
    // upper bound on the displacement of any point of the body in a step, and so on the change of
    // any overlap
    const double distance =
        (wanted.shift.norm() + radius * wanted.turn.norm()) / fusion.injection_steps +
        clock.dt * (wanted.velocity.norm() + radius * wanted.angular_velocity.norm());
    if (fusion.largest_shift <= 0 || distance <= fusion.largest_shift) return 1;
    const double share = fusion.largest_shift / distance;
    return share < least_share ? 0 : share;
}

AnalysisRecord record_of(const SensorFilter& filter, double time, Row sensor, double share,
                         double work) {
    const AnalysisStatistics &position = filter.position(), &attitude = filter.attitude();
    const double axis = 1 / std::sqrt(3.0);
    return {.time = time,
            .sensor = static_cast<double>(sensor),
            .position_innovation = position.innovation.norm(),
            .attitude_innovation = attitude.innovation.norm(),
            .position_normalised_innovation_squared = position.normalised_innovation_squared,
            .attitude_normalised_innovation_squared = attitude.normalised_innovation_squared,
            .position_gain = position.gain.mean(),
            .attitude_gain = attitude.gain.mean(),
            .position_deviation = axis * position.deviation.norm(),
            .attitude_deviation = axis * attitude.deviation.norm(),
            .share = share,
            .work = work};
}

/// Adds the velocity and angular velocity of a correction to a body at once, and accumulates the
/// work.
template <class BodyRows>
void change_motion(const BodyRows& bodies, Row b, const RigidState& now, const Analysis& given,
                   const Vec3& dL, double dt) {
    const Vec3 &dv = given.velocity, &dw = given.angular_velocity;
    const NudgingRow& nudging = bodies.template column<Nudging>()[b];
    double& work = bodies.template column<FusionWork>()[b];
    work += bodies.template column<InertialMass>()[b] * dv.dot(now.velocity + 0.5 * dv) +
            dL.dot(now.angular_velocity + 0.5 * dw);
    // the nudging work of the past step is accumulated in the next step and belongs to the velocity
    // before this change
    work -= 0.5 * dt * (nudging.force.dot(dv) + nudging.torque.dot(dw));
    bodies.template column<Velocity>()[b] += dv;
    bodies.template column<AngularVelocity>()[b] += dw;
    bodies.template column<StepAngularVelocity>()[b] += dw;
    bodies.template column<AngularMomentum>()[b] += dL;
}

template <class BodyRows, class OrientationOf, class MomentumOf, class CountLastTurn>
void fuse(FusedSensors sensors, const BodyRows& bodies, Fusion& fusion, ListState& lists,
          const Replay& replay, const Clock& clock, OrientationOf&& orientation_of,
          MomentumOf&& momentum, CountLastTurn&& count_last_turn) {
    for (Row s = sensors.first(); s < sensors.last(); ++s) {
        std::uint64_t& next = sensors.column<NextSample>()[s];
        const auto& samples = replay.samples[s];
        if (next >= samples.size() || !has_arrived(samples[next].time, fusion, clock)) continue;
        const Row b = row_of(bodies, sensors.column<SensorHost>()[s]);
        const Vec3 &velocity = bodies.template column<Velocity>()[b],
                   &angular_velocity = bodies.template column<AngularVelocity>()[b];
        CorrectionRow& correction = bodies.template column<Correction>()[b];
        const RigidState now = state_of(bodies.template column<Position>()[b], velocity,
                                        bodies.template column<Acceleration>()[b],
                                        orientation_of(b), angular_velocity, clock);
        const Analysis pending = pending_of(correction);
        Analysis to_come = pending;
        SensorFilter& filter = fusion.filters[s];
        const bool taken = assimilate_samples(filter, samples, next, now, to_come, fusion, clock),
                   assimilated = to_come.accepted > 0;
        sensors.column<Accepted>()[s] += to_come.accepted;
        sensors.column<Refused>()[s] += to_come.refused;
        double& largest = sensors.column<LargestInnovation>()[s];
        largest = std::max(largest, to_come.largest_distance);
        const double work = bodies.template column<FusionWork>()[b];
        if (!assimilated) { // refused samples move nothing and do not prolong a pending correction
            if (taken)
                fusion.records.push_back(record_of(filter, now_of(fusion, clock), s, 0, work));
            continue;
        }
        const bool nudged = fusion.nudging.stiffness > 0;
        const double share =
            nudged ? 1
                   : share_in_step(to_come, bodies.template column<BoundingRadius>()[b], fusion,
                                   clock);
        fusion.records.push_back(record_of(filter, now_of(fusion, clock), s, share, work));
        if (share < 1) ++(share > 0 ? sensors.column<Reduced>() : sensors.column<Withheld>())[s];
        if (share == 0) { // nothing is applied, and the filter is informed of it
            filter.withhold(sum_of(to_come, scaled(-1, pending)));
            continue;
        }
        if (share < 1) {
            const Analysis given = scaled(share, to_come);
            filter.withhold(sum_of(to_come, scaled(-1, given)));
            to_come = given;
        }
        change_motion(bodies, b, now, to_come, momentum(b, to_come.angular_velocity), clock.dt);
        lists.velocities_changed = true; // contacts would read the old velocity
        std::uint32_t& guided = bodies.template column<Guided>()[b];
        if (nudged) {
            // the body may follow or not: what it does enters the next forecast
            NudgingTarget target = target_of(now, to_come, fusion);
            count_last_turn(b, target);
            set_nudging(bodies.template column<Nudging>()[b], guided, target, fusion.nudging);
        } else {
            set_correction(correction, guided, to_come.shift, to_come.turn, fusion.injection_steps);
        }
    }
}

} // namespace

void Fusion::save(Archive& archive) const {
    put_fields(archive, "fusion/strain", std::tie(strain));
    save_records(archive, "fusion/records", records);
    for (std::size_t k = 0; k < filters.size(); ++k)
        filters[k].save(archive, fmt::format("fusion/{}", k));
}

void Fusion::load(const Archive& archive) {
    get_fields(archive, "fusion/strain", std::tie(strain));
    records = load_records(archive, "fusion/records");
    for (std::size_t k = 0; k < filters.size(); ++k)
        filters[k].load(archive, fmt::format("fusion/{}", k));
}

void add_sensors(World& world, const std::vector<EntityId>& hosts,
                 std::vector<std::vector<TimedMeasurement>> samples, const FilterSettings& settings,
                 unsigned injection_steps) {
    require(hosts.size() == samples.size(),
            fmt::format("sensors: expected a recording for each of {} hosts, found {}",
                        hosts.size(), samples.size()));
    require(std::set(hosts.begin(), hosts.end()).size() == hosts.size(),
            "sensors: expected one for each host, found two for one host");
    require(injection_steps > 0, "sensors: expected at least one step per correction, found 0");
    Table& table = world.table<Sensors>();
    table.add<SensorId>();
    table.add<SensorHost>();
    table.add<NextSample>();
    table.add<Accepted>();
    table.add<Refused>();
    table.add<Reduced>();
    table.add<Withheld>();
    table.add<LargestInnovation>();
    table.resize(hosts.size());
    for (Row s = 0; s < hosts.size(); ++s) {
        require(std::ranges::is_sorted(samples[s], {}, &TimedMeasurement::time),
                fmt::format("sensor {}: expected samples in the order of time, found another order",
                            s));
        mark_repeated(samples[s]);
        table.column<SensorId>()[s] = s;
        table.column<SensorHost>()[s] = hosts[s];
    }
    world.table<Bodies>().add<Guided>();
    world.table<Bodies>().add<Correction>();
    world.table<Bodies>().add<Nudging>();
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
        if (next[s] < samples[s].size() && has_arrived(samples[s][next[s]].time, fusion, clock))
            return true;
    return false;
}

bool dismiss_samples(World& world) {
    for (Row s = 0; s < world.table<Sensors>().size(); ++s)
        if (is_assimilated(world, s)) return false;
    const System fuse = world.table<Bodies>().has<Orientation>()
                            ? system("fuse_clumps", fuse_clumps)
                            : system("fuse_spheres", fuse_spheres);
    fuse.bind(world)({});
    return true;
}

void fuse_spheres(FusedSensors sensors, FusedBodies<const SphereInertia> bodies, Fusion& fusion,
                  ListState& lists, const Replay& replay, const Clock& clock) {
    const double* inertia = bodies.column<SphereInertia>();
    fuse(
        sensors, bodies, fusion, lists, replay, clock, [](Row) { return Quat::Identity(); },
        [&](Row b, const Vec3& angular_velocity) {
            return momentum_of(inertia[b], angular_velocity);
        },
        [&](Row b, NudgingTarget& target) {
            const Vec3& angular_velocity = bodies.column<StepAngularVelocity>()[b];
            target.attitude = exponential_map(-clock.dt * target.angular_velocity) *
                              target.attitude * exponential_map(clock.dt * angular_velocity);
        });
}

void fuse_clumps(FusedSensors sensors, FusedBodies<const Orientation, const InertialInertia> bodies,
                 Fusion& fusion, ListState& lists, const Replay& replay, const Clock& clock) {
    const Quat* orientation = bodies.column<Orientation>();
    const Vec3* inertia = bodies.column<InertialInertia>();
    fuse(
        sensors, bodies, fusion, lists, replay, clock, [&](Row b) { return orientation[b]; },
        [&](Row b, const Vec3& angular_velocity) {
            return momentum_of(inertia[b], orientation[b], angular_velocity);
        },
        [](Row, NudgingTarget&) {});
}

double fusion_work(const World& world) { return exact_sum(world.column<Bodies, FusionWork>()); }

} // namespace bris
