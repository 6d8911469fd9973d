#include "tests/verification/array.hpp"

#include "engine/errors.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

ImpactArrayResult run_experiment(const ImpactArray& s) {
    require(s.impact.target == Target::plane && s.count > 1,
            "array: expected a plane as target and at least two spheres");
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto mine = materials.add(s.impact.material),
               other = materials.add(s.impact.partner_material);
    materials.policy = s.impact.policy;
    materials.mix();
    add_floor(world, other);
    ImpactArrayResult r;
    std::vector<EntityId> ids;
    // all impacts have the time step of a normal impact and begin in the middle of a step
    const double dt = normal_contact(s.impact).time() / s.impact.steps_per_contact;
    std::uint64_t steps = 0;
    for (unsigned k = 0; k < s.count; ++k) {
        const double angle = s.least_angle + (s.greatest_angle - s.least_angle) * k / (s.count - 1);
        const Vec3 v = s.impact.speed * Vec3(std::sin(angle), 0, -std::cos(angle));
        r.angle.push_back(angle);
        ids.push_back(add_sphere(world,
                                 Vec3(0, 3 * s.impact.radius * k, s.impact.radius) - 2.5 * dt * v,
                                 s.impact.radius, mine));
        value_of<Velocity>(world, ids.back()) = v;
        Impact alone = s.impact;
        alone.angle = angle;
        steps =
            std::max(steps, static_cast<std::uint64_t>(4 * normal_contact(alone).time() / dt) + 10);
    }
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.impact.law, .unlimited = true});
    sim.advance(steps);
    for (unsigned k = 0; k < s.count; ++k) {
        Impact alone = s.impact;
        alone.angle = r.angle[k];
        alone.steps_per_contact = normal_contact(alone).time() / dt;
        alone.phase = 0.5;
        const ImpactResult one = run_experiment(alone);
        const Vec3 v = value_of<Velocity>(sim, ids[k]);
        r.tangential_restitution.push_back(v.x() / (s.impact.speed * std::sin(r.angle[k])));
        const double normal = v.z() / (s.impact.speed * std::cos(r.angle[k]));
        const double angular_velocity =
            s.impact.radius *
            (value_of<AngularVelocity>(sim, ids[k]) - one.angular_velocity).norm() / s.impact.speed;
        r.largest_difference = std::max(
            {r.largest_difference, std::abs(normal - one.normal_restitution), angular_velocity,
             std::abs(r.tangential_restitution.back() - one.tangential_restitution)});
    }
    return r;
}

} // namespace bris
