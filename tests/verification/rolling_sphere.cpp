#include "tests/verification/rolling_sphere.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <cmath>

namespace bris {

RollingSphereResult run_experiment(const RollingSphere& s) {
    require(!is_hertz(s.law), "rolling sphere: expected a linear law");
    require(s.slope >= 0 && s.slope < pi / 2,
            "rolling sphere: expected a slope of at least 0 and below pi/2 rad");
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.material);
    world.resource<Materials>().policy = s.policy;
    world.resource<Materials>().mix();
    add_floor(world, material);
    const EntityId ball = add_sphere(world, Vec3::Zero(), s.radius, material);
    const double mass = value_of<InertialMass>(world, ball), kn = 0.5 * s.material.normal_stiffness;
    const double dt = s.step * std::sqrt(mass / kn);
    value_of<Position>(world, ball).z() =
        s.radius - mass * s.gravity * std::cos(s.slope) / kn; // in equilibrium from the start
    value_of<Velocity>(world, ball).x() = s.speed;
    set_angular_velocity(world, ball, Vec3(0, s.angular_velocity, s.twist));
    world.add_resource<Gravity>({s.gravity * Vec3(std::sin(s.slope), 0, -std::cos(s.slope))});
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});

    RollingSphereResult r;
    r.slip_end = std::nan("");
    r.first_kinetic_energy = free_kinetic_energy(sim.world(), ball);
    r.steps = static_cast<std::uint64_t>(std::ceil(s.duration / dt));
    const double limit = s.material.friction;
    double half_speed = 0, half_time = 0;
    Vec3 half_omega = Vec3::Zero();
    bool slipped = false;
    for (std::uint64_t k = 0; k < r.steps; ++k) {
        sim.advance();
        const double ratio = touch_of(sim.world()).friction_ratio;
        r.friction_ratio = std::max(r.friction_ratio, ratio);
        slipped = slipped || ratio > limit * (1 - 1e-9);
        if (slipped && std::isnan(r.slip_end) && ratio < limit * (1 - 1e-9))
            r.slip_end = dt * (static_cast<double>(k) - 0.5);
        if (k == r.steps / 2) {
            half_speed = value_of<Velocity>(sim, ball).x();
            half_omega = value_of<AngularVelocity>(sim, ball);
            half_time = sim.world().resource<Clock>().time();
        }
    }
    const double time = sim.world().resource<Clock>().time() - half_time;
    const Vec3 omega = value_of<AngularVelocity>(sim, ball);
    r.speed = value_of<Velocity>(sim, ball).x();
    r.angular_velocity = omega.y();
    r.twist = omega.z();
    r.acceleration = (r.speed - half_speed) / time;
    r.angular_acceleration = (omega.y() - half_omega.y()) / time;
    r.twist_acceleration = (omega.z() - half_omega.z()) / time;
    r.kinetic_energy = free_kinetic_energy(sim.world(), ball);
    return r;
}

} // namespace bris
