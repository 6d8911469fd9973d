#include "scenarios/ensemble/twin.hpp"

#include "engine/random_vector.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <algorithm>
#include <numeric>

namespace bris {

namespace {

constexpr std::size_t shells = farthest_shell + 1;

double root_mean(double squares, double count) {
    return count > 0 ? std::sqrt(squares / count) : 0;
}

} // namespace

std::vector<std::size_t> sensor_rocks(const ModelRun& run) {
    std::vector<std::size_t> rocks(run.sensors);
    std::iota(rocks.begin(), rocks.end(), std::size_t{0});
    return rocks;
}

std::vector<SensorTrajectory> recorded_trajectories(const ModelRun& truth,
                                                    const std::vector<std::size_t>& hosts,
                                                    double interval, double position_noise,
                                                    double attitude_noise, std::uint64_t seed,
                                                    const RecordingFaults& faults) {
    std::vector<SensorTrajectory> trajectories(hosts.size());
    for (std::size_t s = 0; s < hosts.size(); ++s) {
        Random random(seed, 1000 + s), fault(seed, 5000 + s);
        const auto noise = [&](double deviation) -> Vec3 {
            return deviation * normal_vector(random);
        };
        double last = 0;
        for (std::size_t stage = 1; stage < truth.curves.size(); ++stage) {
            const double strain = truth.curves[quantity::axial_strain][stage];
            if (strain - last < 0.999 * interval) continue;
            last = strain;
            const bool lost = fault.uniform() < faults.dropout,
                       wrong = fault.uniform() < faults.outliers;
            trajectories[s].strain.push_back(strain);
            trajectories[s].displacement.push_back(truth.displacement[stage][hosts[s]] +
                                                   noise(position_noise));
            const Quat turned = exponential_map(noise(attitude_noise)) *
                                exponential_map(truth.rotation[stage][hosts[s]]);
            trajectories[s].rotation.push_back(attitude_error(turned, Quat::Identity()));
            if (wrong) {
                trajectories[s].displacement.back() +=
                    faults.outlier_displacement * fault.direction();
                trajectories[s].rotation.back() += faults.outlier_rotation * fault.direction();
            }
            if (!lost) continue;
            trajectories[s].strain.pop_back();
            trajectories[s].displacement.pop_back();
            trajectories[s].rotation.pop_back();
        }
    }
    return trajectories;
}

std::vector<Recording> record_sensors(const ModelRun& truth, const RecordingSettings& settings,
                                      std::uint64_t seed) {
    const double period = settings.interval / 1e-4 * settings.stage_time;
    ImuModel model = imu_preset(settings.imu);
    model.rate = 1 / period; // of the means
    model.bandwidth = model.loss = 0;
    model.bits = 0; // noise makes the resolution of a mean finer than a digit
    const auto trajectories =
        recorded_trajectories(truth, sensor_rocks(truth), settings.interval,
                              settings.displacement_noise, settings.attitude_noise, seed);
    std::vector<Recording> recordings(truth.sensors);
    for (std::size_t s = 0; s < truth.sensors; ++s) {
        Recording& r = recordings[s];
        Random random(seed, 2000 + s);
        const auto noise = [&](double deviation) -> Vec3 {
            return deviation * normal_vector(random);
        };
        const RockPose& start = truth.start[s];
        r.info.id = static_cast<unsigned>(s + 1);
        const Quat attitude = exponential_map(noise(settings.levelling_noise)) * start.orientation;
        r.info.set_pose(start.position + noise(settings.placement_noise), attitude);
        r.info.position_deviation = settings.placement_noise;
        r.info.attitude_deviation = settings.levelling_noise * 180 / pi;
        r.info.sampling_rate = model.rate;
        if (model.force_range > 0)
            r.info.force_range = model.force_range; // without limit the default stays
        if (model.rate_range > 0) r.info.rate_range = model.rate_range;
        r.info.force_noise = model.noise.force;
        r.info.rate_noise = model.noise.rate;
        r.info.force_bias = model.force_bias;
        r.info.rate_bias = model.rate_bias;
        r.info.displacement_noise = settings.displacement_noise;
        r.info.attitude_noise = settings.attitude_noise;
        Imu imu(model, Vec3(0, 0, -9.81), seed, 3000 + s);
        Quat before = start.orientation;
        double time = 0;
        const auto sample = [&](double strain, const Vec3& turned, const Vec3& displacement,
                                const Vec3& rotation) {
            const Quat now = exponential_map(turned) * start.orientation;
            time += period;
            const ImuSample one =
                imu.sample(time, {.orientation = now,
                                  .angular_velocity = attitude_error(now, before) / period});
            before = now;
            r.time.push_back(one.time);
            r.sequence.push_back(one.sequence);
            r.strain.push_back(strain);
            r.force.push_back(one.force);
            r.rate.push_back(one.rate);
            r.displacement.push_back(displacement);
            r.attitude.push_back(exponential_map(rotation) * r.info.attitude());
        };
        for (double t = 0; t < settings.rest - 0.5 * period; t += period) {
            const Vec3 turned = noise(settings.attitude_noise);
            sample(0, Vec3::Zero(), noise(settings.displacement_noise), turned);
        }
        std::size_t stage = 0;
        for (std::size_t k = 0; k < trajectories[s].strain.size(); ++k) {
            while (truth.curves[quantity::axial_strain][stage] < trajectories[s].strain[k]) ++stage;
            sample(trajectories[s].strain[k], truth.rotation[stage][s],
                   trajectories[s].displacement[k], trajectories[s].rotation[k]);
        }
    }
    return recordings;
}

const std::vector<std::string>& texts_of(SensorMode) {
    static const std::vector<std::string> texts{"ideal", "tracked", "inertial"};
    return texts;
}

SensorObservations observe_sensors(const ModelRun& truth, const SensorSettings& settings,
                                   std::uint64_t seed) {
    const bool ideal = settings.mode == SensorMode::ideal;
    SensorObservations observations{.trajectories = {},
                                    .position_noise = ideal ? 1e-7 : settings.position_noise,
                                    .attitude_noise = ideal ? 1e-6 : settings.attitude_noise};
    if (settings.mode != SensorMode::inertial) {
        observations.trajectories = recorded_trajectories(
            truth, sensor_rocks(truth), settings.interval, observations.position_noise,
            observations.attitude_noise, seed, settings.faults);
        return observations;
    }
    const RecordingSettings recording{.interval = settings.interval, .imu = settings.imu};
    RecordedTest test;
    test.recordings = record_sensors(truth, recording, seed);
    examine(test, {.rest = recording.rest,
                   .interval = settings.interval,
                   .displacement = false,
                   .attitude = false});
    observations.trajectories = test.trajectories;
    observations.refused = test.refused();
    const double duration =
        truth.curves[quantity::axial_strain].back() / 1e-4 * recording.stage_time;
    for (const Observability& observability :
         observability_of(test.recordings.front(), duration, 1,
                          1)) // noise as declared, the same for all sensors
        if (observability.direction == "tilt")
            observations.attitude_noise = observability.deviation;
    return observations;
}

TwinErrors errors_of(const ModelRun& run, const ModelRun& truth) {
    TwinErrors e;
    const std::size_t stages = std::min(run.curves.size(), truth.curves.size());
    double q = 0, volume = 0, ring = 0, rings = 0;
    std::vector<double> displacement(shells), rotation(shells), count(shells);
    for (std::size_t k = 1; k < stages; ++k) {
        const auto squared = [&](const Quantity& x) {
            return std::pow(run.curves[x][k] - truth.curves[x][k], 2);
        };
        q += squared(quantity::deviatoric_stress);
        volume += squared(quantity::volumetric_strain);
        for (std::size_t r = 0; r < run.curves.rings(); ++r, ++rings)
            ring += std::pow((run.curves.ring(r)[k] - run.curves.ring(r)[0]) -
                                 (truth.curves.ring(r)[k] - truth.curves.ring(r)[0]),
                             2);
        for (std::size_t rock = 0; rock < truth.rocks.size(); ++rock) {
            const std::size_t s = truth.shell[rock];
            displacement[s] +=
                (run.displacement[k][rock] - truth.displacement[k][rock]).squaredNorm();
            rotation[s] += attitude_error(exponential_map(run.rotation[k][rock]),
                                          exponential_map(truth.rotation[k][rock]))
                               .squaredNorm();
            ++count[s];
        }
    }
    const auto n = static_cast<double>(stages - 1);
    e.q = root_mean(q, n);
    e.volumetric_strain = root_mean(volume, n);
    e.ring_radius = root_mean(ring, rings);
    for (std::size_t s = 0; s < shells; ++s) {
        e.displacement.push_back(root_mean(displacement[s], count[s]));
        e.rotation.push_back(root_mean(rotation[s], count[s]));
    }
    return e;
}

} // namespace bris
