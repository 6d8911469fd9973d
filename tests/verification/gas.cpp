#include "tests/verification/gas.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

GasResult run_experiment(const Gas& s) {
    const double time = like_spheres(s.material, s.law, s.radius, s.speed).time(),
                 dt = time / s.steps_per_contact;

    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.material);
    const double pitch = 2.2 * s.radius;
    for (unsigned i = 0; i < s.side * s.side * s.side; ++i) {
        Random random(s.seed, i);
        const Vec3 site =
            pitch * Vec3(i % s.side + 0.5, i / s.side % s.side + 0.5, i / s.side / s.side + 0.5);
        const EntityId id =
            add_sphere(world, site + 0.08 * s.radius * random.direction(), s.radius, material);
        value_of<Velocity>(world, id) = s.speed * random.direction();
    }
    add_box(world, Vec3::Zero(), Vec3::Constant(pitch * s.side), material);
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});

    GasResult r;
    r.steps = static_cast<std::uint64_t>(s.contacts_long * s.steps_per_contact);
    // contact records belong to the positions before the last move, so velocities are taken there
    const auto energy = [&] {
        const World& w = sim.world();
        const auto velocity = w.column<Bodies, Velocity>(),
                   acceleration = w.column<Bodies, Acceleration>(),
                   angular_velocity = w.column<Bodies, StepAngularVelocity>(),
                   torque = w.column<Bodies, Torque>();
        const auto mass = w.column<Bodies, Mass>(), inertia = w.column<Bodies, SphereInertia>();
        double kinetic = 0;
        for (Row b = 0; b < mass.size(); ++b)
            if (mass[b] > 0)
                kinetic +=
                    0.5 *
                    (mass[b] * (velocity[b] - 0.5 * dt * acceleration[b]).squaredNorm() +
                     inertia[b] *
                         (angular_velocity[b] - 0.5 * dt / inertia[b] * torque[b]).squaredNorm());
        const Quantities q = compute_quantities(w);
        r.contacts += static_cast<double>(q.contacts);
        return kinetic + q.elastic_energy;
    };
    sim.advance();
    const double first = energy();
    double lowest = 1, samples = 1;
    const auto every = static_cast<std::uint64_t>(std::max(1.0, s.steps_per_contact / 4));
    for (std::uint64_t k = 0; k < r.steps; k += every) {
        sim.advance(every);
        r.last = energy() / first;
        r.largest_change = std::max(r.largest_change, std::abs(r.last - 1));
        r.largest_gain = std::max(r.largest_gain, r.last - 1);
        r.largest_rise = std::max(r.largest_rise, r.last - lowest);
        lowest = std::min(lowest, r.last);
        ++samples;
    }
    r.contacts /= samples;
    return r;
}

StiffeningResult run_experiment(const Stiffening& s) {
    const double radius = 0.01, speed = 1;
    Material m;
    m.density = 2600;
    m.young_modulus = 1e9;
    m.poisson_ratio = 0.25;
    Impact impact;
    impact.radius = radius;
    impact.material = m;
    impact.partner_material = rigid_material();
    impact.speed = speed;
    const NormalContact contact = normal_contact(impact);
    const double dt = contact.time() / s.steps_per_contact;

    World world = make_world(Grains::spheres);
    const auto mine = world.resource<Materials>().add(m),
               wall = world.resource<Materials>().add(rigid_material());
    add_floor(world, wall);
    const EntityId ball = add_sphere(world, Vec3(0, 0, radius + 2.5 * dt * speed), radius, mine);
    value_of<Velocity>(world, ball).z() = -speed;
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::hertz_frictionless, .unlimited = true});
    StiffeningResult r;
    bool touched = false, changed = false;
    for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(5 * s.steps_per_contact); ++k) {
        sim.advance();
        const double overlap = radius - value_of<Position>(sim, ball).z(),
                     v = value_of<Velocity>(sim, ball).z();
        touched = touched || overlap > 0;
        if (touched && overlap < 0) {
            r.restitution = v / speed;
            r.injected = r.restitution * r.restitution - 1;
            return r;
        }
        if (changed || v <= 0) continue;
        // the sphere rebounds: the next step has the new stiffness at this overlap
        changed = true;
        r.overlap = overlap;
        r.exact = (s.factor - 1) * 0.4 * contact.stiffness * std::pow(overlap, 2.5) /
                  (0.5 * contact.mass * speed * speed);
        sim.world().resource<Materials>().list[mine].young_modulus *= s.factor;
        sim.world().resource<Materials>().mix();
    }
    throw SimulationError("stiffening: the impact does not end");
}

} // namespace bris
