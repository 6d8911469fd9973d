#include "tests/verification/bounce.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace bris {

std::vector<BounceRecord> run_experiment(const Bounce& s) {
    require(s.height > s.radius && s.gravity > 0,
            "bounce: expected a height above the radius and a gravity above 0");
    World world = make_world(Grains::spheres);
    Material m = linear_material(s.stiffness, 0, 0, s.density);
    m.restitution = s.restitution;
    const auto material = world.resource<Materials>().add(m);
    world.resource<Materials>().policy.tension = s.tension;
    world.resource<Materials>().mix();
    add_floor(world, material);
    const EntityId ball = add_sphere(world, s.height * Vec3::UnitZ(), s.radius, material);
    const double mass = value_of<InertialMass>(world, ball);
    // the first contact begins in the middle of a step
    const double fall = std::sqrt(2 * (s.height - s.radius) / s.gravity);
    const double wanted = pi * std::sqrt(mass / s.stiffness) / s.steps_per_contact,
                 dt = fall / (std::round(fall / wanted) + 0.5);
    value_of<Velocity>(world, ball).z() = 0.5 * s.gravity * dt;
    world.add_resource<Gravity>({Vec3(0, 0, -s.gravity)});
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous, .unlimited = true});

    std::vector<BounceRecord> list;
    const double g = s.gravity, most_steps = 1e3 * s.bounces * (fall / dt + s.steps_per_contact);
    bool touching = false;
    Peak overlap;
    while (sim.world().resource<Clock>().step < static_cast<std::uint64_t>(most_steps)) {
        sim.advance();
        const double time = sim.world().resource<Clock>().time(),
                     z = value_of<Position>(sim, ball).z();
        const double last = value_of<Velocity>(sim, ball).z(); // half a step ago
        if (touching) overlap.add(touch_of(sim.world()).overlap);
        if (z < s.radius && !touching) {
            // trace the parabola of the flight back to the first touch
            touching = true;
            const double now = last - 0.5 * g * dt,
                         in = std::sqrt(now * now - 2 * g * (s.radius - z));
            list.push_back({});
            list.back().begin = time - (-now - in) / g;
            list.back().speed_in = in;
            overlap = {};
        } else if (z >= s.radius && touching) {
            touching = false;
            const double now = last - 0.5 * g * dt,
                         out = std::sqrt(now * now + 2 * g * (z - s.radius));
            list.back().end = time - (out - now) / g;
            list.back().speed_out = out;
            list.back().overlap = overlap.value();
            list.back().apex = z + 0.5 * now * now / g;
            if (list.size() == s.bounces) return list;
        }
    }
    throw SimulationError("bounce: the sphere came to rest before the last bounce");
}

StackResult run_experiment(const Stack& s) {
    World world = make_world(Grains::spheres);
    Material m = linear_material(s.stiffness, 0, 0, s.density[0]);
    m.restitution = s.restitution;
    const auto lower = world.resource<Materials>().add(m);
    m.density = s.density[1];
    const auto upper = world.resource<Materials>().add(m);
    const EntityId host = add_boundary(world, Vec3::Zero(), lower);
    add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    add_plane(world, host, s.lid * Vec3::UnitZ(), -Vec3::UnitZ());
    const std::array<EntityId, 2> ids{
        add_sphere(world, s.begin[0] * Vec3::UnitZ(), s.radius, lower),
        add_sphere(world, s.begin[1] * Vec3::UnitZ(), s.radius, upper)};
    const double m0 = value_of<InertialMass>(world, ids[0]),
                 m1 = value_of<InertialMass>(world, ids[1]), k = s.stiffness;

    // d/dt (z0, z1, v0, v1, 1): a linear system
    const double beta = damping_ratio(s.restitution, Tension::allowed), mm = m0 * m1 / (m0 + m1);
    const double c0 = 2 * beta * std::sqrt(k * m0), c1 = 2 * beta * std::sqrt(k * m1),
                 c = 2 * beta * std::sqrt(k * mm);
    Eigen::Matrix<double, 5, 5> system = Eigen::Matrix<double, 5, 5>::Zero();
    system(0, 2) = system(1, 3) = 1;
    system.row(2) << -2 * k / m0, k / m0, -(c0 + c) / m0, c / m0,
        k * (s.radius - 2 * s.radius) / m0 - s.gravity;
    system.row(3) << k / m1, -2 * k / m1, c / m1, -(c1 + c) / m1,
        k * (2 * s.radius + s.lid - s.radius) / m1 - s.gravity;
    Eigen::Matrix<double, 5, 1> state;
    state << s.begin[0], s.begin[1], 0, 0, 1;

    const double wanted = s.step * std::sqrt(m1 / k);
    StackResult r;
    r.steps = static_cast<std::uint64_t>(std::ceil(s.duration / wanted));
    const double dt = s.duration / static_cast<double>(r.steps);
    // Taylor series of the matrix exponential: the step is far below the period, so 12 terms are
    // exact to rounding
    Eigen::Matrix<double, 5, 5> term = Eigen::Matrix<double, 5, 5>::Identity(), step = term;
    for (int i = 1; i <= 12; ++i) {
        term = term * system * (dt / i);
        step += term;
    }
    const Eigen::Matrix<double, 5, 1> rate = system * state;
    for (std::size_t i = 0; i < 2; ++i) // at rest at t = 0
        value_of<Velocity>(world, ids[i]).z() = -0.5 * dt * rate[static_cast<Eigen::Index>(i) + 2];
    world.add_resource<Gravity>({Vec3(0, 0, -s.gravity)});
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous, .unlimited = true});
    for (std::uint64_t n = 0; n < r.steps; ++n) {
        sim.advance();
        state = step * state;
        if (n > 0 && touch_of(sim.world()).pairs != 3)
            throw SimulationError("stack: a contact has opened");
        for (std::size_t i = 0; i < 2; ++i) {
            r.height[i] = value_of<Position>(sim, ids[i]).z();
            r.exact[i] = state[static_cast<Eigen::Index>(i)];
            r.largest_error = std::max(r.largest_error, std::abs(r.height[i] - r.exact[i]));
            r.travel = std::max(r.travel, std::abs(r.exact[i] - s.begin[i]));
        }
    }
    return r;
}

double run_experiment(const DampedFall& s) {
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(linear_material(1e5));
    const EntityId ball = add_sphere(world, Vec3::Zero(), 0.01, material);
    value_of<Velocity>(world, ball).z() = s.speed;
    world.add_resource<Gravity>({Vec3(0, 0, -s.gravity)});
    world.add_resource(LocalDamping{s.fraction});
    // so short that the velocity keeps its sign
    const double dt = 0.5 * std::abs(s.speed) / (s.gravity * s.steps);
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless, .unlimited = true});
    sim.advance(s.steps);
    return -(value_of<Velocity>(sim, ball).z() - s.speed) / (s.gravity * dt * s.steps);
}

} // namespace bris
