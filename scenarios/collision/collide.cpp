#include "scenarios/collision/collide.hpp"

#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random_vector.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/fusion/fuse.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

constexpr EntityId first = 0;

/// Positions (m) of the balls that are hit: the first one lies at the origin, the others lie in
/// rows behind it.
std::vector<Vec3> targets(const Collide& s) {
    std::vector<Vec3> positions;
    const double pitch = 2.001 * s.radius;
    for (unsigned row = 0; positions.size() + 1 < s.balls; ++row)
        for (unsigned k = 0; k <= row && positions.size() + 1 < s.balls; ++k)
            positions.emplace_back(row * pitch * std::sqrt(0.75), (k - 0.5 * row) * pitch, 0);
    return positions;
}

struct Setting {
    double speed, offset, restitution;
};

Simulation make_run(const Collide& s, const Setting& setting,
                    const std::vector<TimedMeasurement>* recording, double dt) {
    World world = make_world(Grains::spheres);
    Material material = s.material;
    material.restitution = setting.restitution;
    auto& materials = world.resource<Materials>();
    const auto m = materials.add(material);
    materials.mix();
    const double y = setting.offset * s.radius,
                 touching = std::sqrt(4 * s.radius * s.radius - std::pow(s.offset * s.radius, 2));
    (void)add_sphere(world, Vec3(-touching - s.gap, y, 0), s.radius, m);
    for (const Vec3& position : targets(s)) (void)add_sphere(world, position, s.radius, m);
    value_of<Velocity>(world, first) = Vec3(setting.speed, 0, 0);
    if (recording != nullptr)
        add_sensors(world, {first}, {*recording}, s.filter, s.injection_steps);
    return begin(std::move(world),
                 {.dt = dt, .law = s.law, .energy_budget = has_springs(s.law), .unlimited = true});
}

double kinetic_energy(const Collide& s, World& world) {
    double sum = 0;
    for (EntityId b = 0; b < s.balls; ++b) sum += free_kinetic_energy(world, b);
    return sum;
}

std::vector<Vec3> velocities(const Collide& s, World& world) {
    std::vector<Vec3> v;
    for (EntityId b = 0; b < s.balls; ++b) v.push_back(value_of<Velocity>(world, b));
    return v;
}

double error_of_others(const std::vector<Vec3>& found, const std::vector<Vec3>& truth) {
    double sum = 0;
    for (std::size_t k = 1; k < truth.size(); ++k) sum += (found[k] - truth[k]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size() - 1));
}

/// State of the first ball when it touches the second.
struct FirstTouch {
    bool seen = false;
    /// Velocity just before the touch, m/s, and unit vector along the line of centres.
    Vec3 velocity = Vec3::Zero(), line = Vec3::UnitX();

    /// Velocity (m/s) that a frictionless impact gives to a second ball of the same mass.
    Vec3 given(double restitution) const {
        return 0.5 * (1 + restitution) * velocity.dot(line) * line;
    }
};

/// Advances by one step and records the first touch.
void advance(Simulation& run, FirstTouch& touch) {
    const Vec3 before = value_of<Velocity>(run, first);
    run.advance();
    if (touch.seen || touch_of(run.world()).pairs == 0) return;
    touch = {true, before,
             (value_of<Position>(run, first + 1) - value_of<Position>(run, first)).normalized()};
}

} // namespace

void check(const Collide& s) {
    require(s.balls >= 2, fmt::format("collide: expected at least two balls, found {}", s.balls));
    require(s.radius > 0 && s.speed > 0 && s.gap > 0 && s.after > 0 && s.sampling_rate > 0,
            "collide: expected radius, speed, gap, time after the touch and sampling rate above 0");
    require(std::abs(s.offset) < 2 && std::abs(s.offset + s.model_offset) < 2,
            "collide: expected offsets of the path within two radii");
    require(s.model_speed > 0,
            fmt::format("collide: expected a model speed above 0, found {:g}", s.model_speed));
}

CollideResult run_experiment(const Collide& s) {
    check(s);
    const double dt =
        like_spheres(s.material, s.law, s.radius, s.speed).time() / s.steps_per_contact;
    const auto steps = static_cast<std::uint64_t>((s.gap / s.speed + s.after) / dt);
    CollideResult r;
    r.steps = steps;

    // the truth and the recording of its sensor
    std::vector<TimedMeasurement> recording;
    Simulation truth = make_run(s, {s.speed, s.offset, s.material.restitution}, nullptr, dt);
    Random random(s.seed, 0);
    const auto noise = [&](double deviation) -> Vec3 { return deviation * normal_vector(random); };
    const double least_deviation = 1e-12; // standard deviation of a sensor without noise
    FirstTouch true_touch;
    for (std::uint64_t k = 0; k < steps; ++k) {
        advance(truth, true_touch);
        const double time = truth.world().resource<Clock>().time();
        if (time * s.sampling_rate < static_cast<double>(recording.size() + 1)) continue;
        TimedMeasurement m{time, {}};
        const Vec3 velocity =
            value_of<Velocity>(truth, first) + 0.5 * dt * value_of<Acceleration>(truth, first);
        if (s.position_noise >= 0)
            m.what.position = value_of<Position>(truth, first) + noise(s.position_noise);
        if (s.velocity_noise >= 0) m.what.velocity = velocity + noise(s.velocity_noise);
        m.what.position_deviation = std::max(s.position_noise, least_deviation);
        m.what.velocity_deviation = std::max(s.velocity_noise, least_deviation);
        recording.push_back(m);
    }
    r.truth = velocities(s, truth.world());

    // the model, without the recording and with it
    const Setting model{s.model_speed * s.speed, s.offset + s.model_offset,
                        s.model_restitution < 0 ? s.material.restitution : s.model_restitution};
    Simulation free = make_run(s, model, nullptr, dt);
    free.advance(steps);
    r.free = velocities(s, free.world());

    Simulation fused = make_run(s, model, &recording, dt);
    const double energy_before = kinetic_energy(s, fused.world());
    FirstTouch touch;
    for (std::uint64_t k = 0; k < steps; ++k) advance(fused, touch);
    if (touch.seen) r.error_at_touch = (touch.velocity - Vec3(s.speed, 0, 0)).dot(touch.line);
    r.fused = velocities(s, fused.world());
    r.free_error = error_of_others(r.free, r.truth);
    r.fused_error = error_of_others(r.fused, r.truth);
    r.carried = r.fused[1] - r.truth[1];
    r.expected = touch.given(model.restitution) - true_touch.given(s.material.restitution);
    r.carried_error = r.carried.dot(touch.line);
    r.expected_error = r.expected.dot(touch.line);
    r.accepted = fused.world().column<Sensors, Accepted>()[0];
    r.refused = fused.world().column<Sensors, Refused>()[0];
    r.fusion_work = fusion_work(fused.world());
    r.energy_error = kinetic_energy(s, fused.world()) - energy_before +
                     dissipated_in_contacts(fused.world()) - r.fusion_work;
    return r;
}

} // namespace bris
