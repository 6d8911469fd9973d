#include "systems/recorder/record_motion.hpp"

#include <string>

namespace bris {

namespace {

constexpr std::size_t numbers_per_sample = 10;

std::string path_of(const InertialRecorder& recorder) {
    return "recorder/" + std::to_string(recorder.body);
}
std::string exact_path_of(const InertialRecorder& recorder) { return path_of(recorder) + "/exact"; }

std::vector<double> numbers_of(const std::vector<ImuSample>& samples) {
    std::vector<double> numbers;
    numbers.reserve(numbers_per_sample * samples.size());
    for (const ImuSample& s : samples) {
        numbers.push_back(s.time);
        numbers.push_back(static_cast<double>(s.sequence));
        numbers.insert(numbers.end(), s.force.data(), s.force.data() + 3);
        numbers.insert(numbers.end(), s.rate.data(), s.rate.data() + 3);
        numbers.push_back(s.saturated ? 1 : 0);
        numbers.push_back(s.lost ? 1 : 0);
    }
    return numbers;
}

std::vector<ImuSample> samples_of(const std::vector<double>& n) {
    std::vector<ImuSample> samples;
    for (std::size_t k = 0; k + numbers_per_sample <= n.size(); k += numbers_per_sample)
        samples.push_back({.time = n[k],
                           .sequence = static_cast<std::uint64_t>(n[k + 1]),
                           .force = Vec3(n[k + 2], n[k + 3], n[k + 4]),
                           .rate = Vec3(n[k + 5], n[k + 6], n[k + 7]),
                           .saturated = n[k + 8] != 0,
                           .lost = n[k + 9] != 0});
    return samples;
}

void save(Archive& archive, const RecordingImu& recording, const std::string& path) {
    recording.imu.save(archive, path);
    archive.put(path + "/samples", std::span<const double>(numbers_of(recording.samples)));
}

void load(const Archive& archive, RecordingImu& recording, const std::string& path) {
    recording.imu.load(archive, path);
    recording.samples = samples_of(archive.get<double>(path + "/samples"));
}

/// Lets the device follow the motion, and takes the sample if it is due.
void record(RecordingImu& recording, const TrueMotion& motion, double start, const Clock& clock) {
    recording.imu.sense(clock.dt, motion);
    const double next =
        start + static_cast<double>(recording.samples.size()) / recording.imu.model().rate;
    if (clock.time() + 0.5 * clock.dt > next)
        recording.samples.push_back(recording.imu.read(clock.time()));
}

} // namespace

void InertialRecorders::save(Archive& archive) const {
    put_fields(archive, "recorder/settings", std::tie(running, start));
    for (const InertialRecorder& recorder : list) {
        bris::save(archive, recorder.device, path_of(recorder));
        bris::save(archive, recorder.exact, exact_path_of(recorder));
    }
}

void InertialRecorders::load(const Archive& archive) {
    get_fields(archive, "recorder/settings", std::tie(running, start));
    for (InertialRecorder& recorder : list) {
        bris::load(archive, recorder.device, path_of(recorder));
        bris::load(archive, recorder.exact, exact_path_of(recorder));
    }
}

bool is_recording(const World& world) {
    return world.has_resource<InertialRecorders>() && world.resource<InertialRecorders>().running;
}

void note_motion(Rows<Bodies, const RecorderOf, const MotionOf, const Force, const Torque,
                      const InertialMass, const InertialInertia, const Orientation,
                      const AngularVelocity, const Velocity, const DriveVelocity>
                     bodies,
                 const InertialRecorders& recorders, NotedMotions& motions, const Clock& clock) {
    if (!recorders.running) return;
    const std::uint32_t* number = bodies.column<RecorderOf>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        const Quat& q = bodies.column<Orientation>()[b];
        const Vec3& omega = bodies.column<AngularVelocity>()[b];
        TrueMotion& motion = motions.of[number[b] - 1];
        motion = {.orientation = q, .angular_velocity = omega};
        if (bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free)) {
            motion.acceleration = bodies.column<Force>()[b] / bodies.column<InertialMass>()[b];
            const Vec3& inertia = bodies.column<InertialInertia>()[b];
            const Vec3 local = q.conjugate() * omega;
            const Vec3 torque = q.conjugate() * bodies.column<Torque>()[b];
            motion.angular_acceleration =
                q *
                Vec3((torque - local.cross(local.cwiseProduct(inertia))).cwiseQuotient(inertia));
        } else {
            motion.acceleration =
                (bodies.column<DriveVelocity>()[b] - bodies.column<Velocity>()[b]) / clock.dt;
        }
    }
}

void record_motion(const NotedMotions& motions, InertialRecorders& recorders, const Clock& clock,
                   const Health& health) {
    if (health.bad) return;
    for (std::size_t k = 0; k < recorders.list.size(); ++k) {
        InertialRecorder& recorder = recorders.list[k];
        record(recorder.device, motions.of[k], recorders.start, clock);
        record(recorder.exact, motions.of[k], recorders.start, clock);
    }
}

} // namespace bris
