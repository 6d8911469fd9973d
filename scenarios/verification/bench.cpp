#include "scenarios/verification/bench.hpp"

#include "components/settings.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/steps.hpp"

#include <algorithm>

namespace bris {

Simulation begin(World world, LawName law, double dt, bool energy_budget, unsigned threads) {
    world.resource<Clock>().dt = dt;
    Limits& limits = world.resource<Limits>();
    limits.overlap = 2; // mean radii, which no contact reaches
    limits.speed = std::numeric_limits<double>::max();
    add_lists(world, law);
    if (energy_budget) add_energy_budget(world);
    Simulation simulation(std::move(world), steps(law, energy_budget), threads);
    simulation.on_restore(forget_lists);
    return simulation;
}

Touch touch_of(const World& world) {
    Touch t;
    for_each_kind_of_pair([&]<class Pairs>() {
        for (const TouchingPair& p : touching_pairs<Pairs>(world)) {
            const Vec3 force(p.force.fx, p.force.fy, p.force.fz);
            ++t.pairs;
            t.overlap = std::max(t.overlap, p.force.overlap);
            t.normal_force += p.force.normal_force;
            t.force += force;
            t.spring = p.spring;
            const double n = p.force.normal_force,
                         shear = std::sqrt(std::max(0.0, force.squaredNorm() - n * n));
            if (n > 0) t.friction_ratio = std::max(t.friction_ratio, shear / n);
        }
    });
    return t;
}

double free_kinetic_energy(World& world, EntityId body) {
    const Vec3& w = value_of<AngularVelocity>(world, body);
    return 0.5 *
           (value_of<InertialMass>(world, body) * value_of<Velocity>(world, body).squaredNorm() +
            w.dot(angular_momentum(world, body, w)));
}

} // namespace bris
