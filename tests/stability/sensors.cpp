// S11: faulty sensors: the state stays finite, impossible samples are refused, and the bodies move
// as without these samples.
#include "engine/random_vector.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/sensors/quality_control.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fusion/fuse.hpp"
#include "tests/stability/cases.hpp"
#include "tests/stability/observed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace bris {

namespace {

constexpr double dt = 2e-5, interval = 1e-3;         // s
constexpr std::uint64_t steps_each = 50;             // per interval
constexpr unsigned good_ones = 20, all_of_them = 40; // samples of each sensor
constexpr std::array<EntityId, 2> hosts{3, 17};
constexpr EntityId another = 39;
constexpr double infinite = std::numeric_limits<double>::infinity(), diameter = 0.018; // m

using Samples = std::vector<TimedMeasurement>;

Tumble bed(std::uint64_t seed) { return {.grains = Grains::clumps, .bodies = 40, .seed = seed}; }
Simulation start(World world) {
    return begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
}

/// Recordings of the sensors on the hosts, and of one on another rock, in a bed that tumbles.
std::vector<Samples> record(std::uint64_t seed) {
    Simulation truth = start(tumbling(bed(seed)));
    Random random(seed, 1100);
    std::vector<Samples> all(hosts.size() + 1);
    for (unsigned k = 1; k <= all_of_them; ++k) {
        truth.advance(steps_each);
        for (std::size_t s = 0; s < all.size(); ++s)
            all[s].push_back(
                {interval * k, observed(truth, s < hosts.size() ? hosts[s] : another, random)});
    }
    return all;
}

/// A fault of all samples from the middle of the recording on.
struct Fault {
    const char* what;
    void (*spoil)(TimedMeasurement& sample, const Samples& good,
                  const TimedMeasurement& of_another);
    bool is_found = true; ///< a filter refuses every faulty sample
    double gate = 0.999, largest_shift = 0;
};

/// A measurement of the position only.
Measured position(const Vec3& x) {
    Measured m;
    m.position = x;
    m.position_deviation = position_deviation;
    return m;
}
Measured attitude(const Quat& q) {
    Measured m;
    m.attitude = q;
    m.attitude_deviation = attitude_deviation;
    return m;
}

constexpr std::array faults{
    Fault{"no data", [](auto& m, auto&, auto&) { m.what = {}; }},
    Fault{"infinite values",
          [](auto& m, auto&, auto&) {
              m.what.position = m.what.velocity = m.what.angular_velocity =
                  Vec3(infinite, 0, -infinite),
              m.what.attitude.coeffs().setConstant(infinite);
          }},
    Fault{"spikes of a metre",
          [](auto& m, auto&, auto&) { m.what = position(m.what.position + Vec3(0, 1, 0)); }},
    Fault{"spikes of 1e300 m",
          [](auto& m, auto&, auto&) { m.what = position(Vec3::Constant(1e300)); }},
    Fault{"millimetres instead of metres",
          [](auto& m, auto&, auto&) { m.what = position(1e3 * m.what.position); }},
    Fault{"degrees instead of radians",
          [](auto& m, auto&, auto&) {
              m.what.angular_velocity *= 180 / pi,
                  m.what.position = m.what.velocity = Measured().position,
                  m.what.attitude = Measured().attitude;
          },
          false},
    Fault{"opposite sign", [](auto& m, auto&, auto&) { m.what = position(-m.what.position); }},
    Fault{"attitude in another frame",
          [](auto& m, auto&, auto&) { m.what = attitude(m.what.attitude * Quat(0, 1, 0, 0)); }},
    Fault{"a quaternion of zeros",
          [](auto& m, auto&, auto&) { m.what = attitude(Quat(0, 0, 0, 0)); }},
    Fault{"a quaternion of norm 2",
          [](auto& m, auto&, auto&) {
              m.what = attitude(Quat(Eigen::Vector4d(2 * m.what.attitude.coeffs())));
          }},
    Fault{"data of another sensor",
          [](auto& m, auto&, const TimedMeasurement& other) {
              m.what = position(other.what.position);
          }},
    Fault{"the last good sample repeated",
          [](TimedMeasurement& m, const Samples& good, auto&) {
              m = {good[good_ones - 1].time, good[good_ones - 1].what};
          }},
    Fault{"a clock 10 s ahead", [](auto& m, auto&, auto&) { m.time += 10; }},
    Fault{"a shift of ten diameters, no gate",
          [](auto& m, auto&, auto&) {
              m.what = position(m.what.position + Vec3(10 * diameter, 0, 0));
          },
          true, 1, 1e-6},
    Fault{
        "a stuck sensor",
        [](TimedMeasurement& m, const Samples& good, auto&) { m.what = good[good_ones - 1].what; },
        false, 0.999, 1e-6},
    Fault{"a bias of ten standard deviations",
          [](auto& m, auto&, auto&) { m.what.position += 10 * position_deviation * Vec3(1, 0, 0); },
          false, 0.999, 1e-6},
};

Simulation with_sensors(std::uint64_t seed, std::vector<Samples> samples, const Fault& fault) {
    World world = tumbling(bed(seed));
    add_sensors(world, {hosts.begin(), hosts.end()}, std::move(samples),
                {.position = 1e-4,
                 .velocity = 0.1,
                 .attitude = 0.02,
                 .angular_velocity = 1,
                 .acceleration_density = 0.1,
                 .angular_acceleration_density = 1e3,
                 .gate = fault.gate},
                40);
    world.resource<Fusion>().largest_shift = fault.largest_shift;
    return start(std::move(world));
}

/// Hash of the whole state except that of sensors and filters.
std::uint64_t mechanics(const Simulation& sim) {
    const Archive all = sim.snapshot();
    Archive some;
    for (const auto& array : all.arrays())
        if (!array.path.starts_with("sensors/") && !array.path.starts_with("fusion/"))
            some.put(array);
    return fingerprint(some);
}

bool all_finite(const Simulation& sim) {
    const Table& bodies = sim.world().table<Bodies>();
    const auto finite = [](const auto& column) {
        return std::ranges::all_of(column, [](const auto& v) { return v.allFinite(); });
    };
    const bool knows =
        std::ranges::all_of(sim.world().resource<Fusion>().filters,
                            [](const SensorFilter& f) { return f.covariance().allFinite(); });
    return knows && finite(bodies.column<Position>()) && finite(bodies.column<Velocity>()) &&
           finite(bodies.column<AngularMomentum>()) && std::isfinite(fusion_work(sim.world()));
}

template <class Component>
std::uint64_t counted(const Simulation& sim) {
    std::uint64_t sum = 0;
    for (const auto number : sim.world().column<Sensors, Component>()) sum += number;
    return sum;
}

/// Initial kinetic energy (J) of the bed. Corrections may add a small fraction of it only.
double energy_of(std::uint64_t seed) {
    const World world = tumbling(bed(seed));
    const auto mass = world.column<Bodies, Mass>();
    const auto velocity = world.column<Bodies, Velocity>();
    double sum = 0;
    for (std::size_t b = 0; b < mass.size(); ++b) sum += 0.5 * mass[b] * velocity[b].squaredNorm();
    return sum;
}

void add_fault(StressRows& rows, std::uint64_t seed, const Fault& fault,
               const std::vector<Samples>& recorded) {
    std::vector<Samples> good(recorded.begin(), recorded.begin() + hosts.size()), bad = good;
    for (Samples& samples : good) samples.resize(good_ones, {0, {}});
    for (std::size_t s = 0; s < hosts.size(); ++s) {
        for (unsigned k = good_ones; k < all_of_them; ++k)
            fault.spoil(bad[s][k], recorded[s], recorded.back()[k]);
    }
    Simulation without = with_sensors(seed, std::move(good), fault),
               with = with_sensors(seed, std::move(bad), fault);
    const std::string stop = refusal_of([&] {
        without.advance(steps_each * all_of_them + 1);
        with.advance(steps_each * all_of_them + 1);
    });
    const bool same = mechanics(with) == mechanics(without), finite = all_finite(with),
               assimilated = counted<Accepted>(without) > hosts.size() * good_ones;
    const double work = fusion_work(with.world()), energy = energy_of(seed);
    const auto found = fmt::format(
        "{}, {} refused, {} withheld, work {:.1e} J of {:.1e} J, {}",
        finite ? "finite" : "not finite", counted<Refused>(with) - counted<Refused>(without),
        counted<Withheld>(with), work, energy, same ? "the same bits" : "other bits");
    rows.push_back(
        {"S11", fmt::format("sensors in a bed: {}", fault.what),
         fault.is_found
             ? "finite, bodies move as if the recordings had ended"
             : "finite, work of fusion below the sensors' share of the bed's energy, 5 %",
         stop.empty() ? found : stop,
         stop.empty() && finite && assimilated &&
             (fault.is_found ? same : std::abs(work) < 0.05 * energy)});
}

/// Every third sample has a spike. The good samples between are used as if the spikes were absent.
void add_spikes_between(StressRows& rows, std::uint64_t seed,
                        const std::vector<Samples>& recorded) {
    std::vector<Samples> spiked(recorded.begin(), recorded.begin() + hosts.size()),
        few(hosts.size());
    for (std::size_t s = 0; s < hosts.size(); ++s)
        for (unsigned k = 0; k < good_ones; ++k) {
            if (k % 3 == 2)
                spiked[s][k].what = position(spiked[s][k].what.position + Vec3(0, 0, 0.1));
            else
                few[s].push_back(spiked[s][k]);
        }
    for (Samples& samples : spiked) samples.resize(good_ones, {0, {}});
    Simulation with = with_sensors(seed, std::move(spiked), faults[0]),
               without = with_sensors(seed, std::move(few), faults[0]);
    with.advance(steps_each * good_ones);
    without.advance(steps_each * good_ones);
    double error = 0;
    for (const EntityId host : hosts)
        error = std::max(
            error, (value_of<Position>(with, host) - value_of<Position>(without, host)).norm());
    rows.push_back(
        {"S11", "sensors in a bed: a spike of 0.1 m in every third sample",
         "sensor bodies within one standard deviation, 1e-5 m, of a run without spikes",
         fmt::format("{} refused, {:.1e} m", counted<Refused>(with) - counted<Refused>(without),
                     error),
         error < position_deviation && counted<Refused>(with) > counted<Refused>(without)});
}

/// Recording of five seconds of a rock that is at rest for two seconds and then shaken.
Recording recording(std::uint64_t seed) {
    const ImuModel model = imu_preset("smartrock-like");
    const Vec3 earth(0, 0, -9.81);
    Recording r;
    const Quat q = Random(seed, 1101).rotation();
    r.info.id = 1;
    r.info.set_pose(Vec3::Zero(), q);
    r.info.sampling_rate = model.rate;
    r.info.force_noise = model.noise.force;
    r.info.rate_noise = model.noise.rate;
    Imu imu(model, earth, seed, 1);
    Random random(seed, 1102);
    const auto noise = [&]() -> Vec3 { return r.info.attitude_noise * normal_vector(random); };
    for (int k = 0; k < 1000; ++k) {
        const double t = k / model.rate, w = t > 2 ? 4 : 0;
        const ImuSample s = imu.sample(t, {.orientation = q,
                                           .acceleration = Vec3(0.5 * std::sin(w * t), 0, 0),
                                           .angular_velocity = Vec3(0, 0.1 * std::sin(w * t), 0)});
        r.time.push_back(s.time);
        r.sequence.push_back(s.sequence);
        r.force.push_back(s.force);
        r.rate.push_back(s.rate);
        r.attitude.push_back(exponential_map(noise()) * q);
    }
    return r;
}

struct Spoilt {
    const char *what, *check; ///< fault, and name of the check that refuses it
    void (*spoil)(Recording& r);
};
constexpr std::array recordings{
    Spoilt{"no fault", "", [](Recording&) {}},
    Spoilt{"NaN in a force", "numbers",
           [](Recording& r) { r.force[700].y() = std::numeric_limits<double>::quiet_NaN(); }},
    Spoilt{"an infinite angular rate", "numbers", [](Recording& r) { r.rate[700].x() = infinite; }},
    Spoilt{"forces in g", "gravity",
           [](Recording& r) {
               for (Vec3& f : r.force) f /= 9.81;
           }},
    Spoilt{"forces of the opposite sign", "frame",
           [](Recording& r) {
               for (Vec3& f : r.force) f = -f;
           }},
    Spoilt{"axes of another frame", "frame",
           [](Recording& r) {
               for (Vec3& f : r.force) f = Vec3(f.y(), f.z(), f.x());
           }},
    Spoilt{"a stuck force channel", "stuck",
           [](Recording& r) { std::fill(r.force.begin() + 500, r.force.end(), r.force[500]); }},
    Spoilt{"a duplicate sample", "twice", [](Recording& r) { r.time[700] = r.time[699]; }},
    Spoilt{"samples out of order", "order",
           [](Recording& r) { std::swap(r.time[700], r.time[705]); }},
    Spoilt{"a clock that gains 1 %", "clock",
           [](Recording& r) {
               for (double& t : r.time) t *= 1.01;
           }},
    Spoilt{"a quaternion of zeros", "attitude",
           [](Recording& r) { r.attitude[700].coeffs().setZero(); }},
    Spoilt{"a sensor that fails at once", "length", [](Recording& r) { r.time.resize(1); }},
};

void add_recordings(StressRows& rows, std::uint64_t seed) {
    for (const Spoilt& spoilt : recordings) {
        Recording r = recording(seed);
        spoilt.spoil(r);
        const auto findings = check_recordings({r}, Vec3(0, 0, -9.81));
        const auto refusal = std::ranges::find(findings, Finding::Kind::refusal, &Finding::kind);
        const bool refused = refusal != findings.end(), wanted = *spoilt.check != '\0';
        rows.push_back(
            {"S11", fmt::format("quality control: {}", spoilt.what),
             wanted ? fmt::format("refused: {}", spoilt.check) : "accepted",
             refused ? fmt::format("refused: {}: {}", refusal->check, refusal->text) : "accepted",
             refused == wanted && (!wanted || refusal->check == spoilt.check)});
    }
}

} // namespace

StressRows stress_sensors(const StressSettings& s) {
    StressRows rows;
    for (std::uint64_t seed = s.seed; seed < s.seed + (s.full ? 10 : 1); ++seed) {
        const auto recorded = record(seed);
        for (const Fault& fault : faults) add_fault(rows, seed, fault, recorded);
        add_spikes_between(rows, seed, recorded);
        add_recordings(rows, seed);
    }
    return rows;
}

} // namespace bris
