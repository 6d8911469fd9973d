#include "systems/experiments/bench.hpp"

#include "components/settings.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/ledger.hpp"
#include "systems/steps.hpp"

#include <algorithm>

namespace bris {

Vec3 angular_momentum(World& world, EntityId body, const Vec3& spin) {
    if (world.table<Bodies>().has<SphereInertia>()) return value_of<SphereInertia>(world, body) * spin;
    const Quat& q = value_of<Orientation>(world, body);
    const Vec3 local = q.conjugate() * spin;
    return q * Vec3(local.cwiseProduct(value_of<InertialInertia>(world, body)));
}

Simulation begin(World world, LawName law, double dt, bool ledger, unsigned threads) {
    world.resource<Clock>().dt = dt;
    Limits& limits = world.resource<Limits>();
    limits.overlap = 2; // of the mean radius: whatever is touched
    limits.speed = std::numeric_limits<double>::max();
    add_lists(world, law);
    if (ledger) add_ledger(world);
    Simulation simulation(std::move(world), steps(law, ledger), threads);
    simulation.on_restore(forget_lists);
    return simulation;
}

EntityId add_floor(World& world, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material);
    add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    return host;
}

Material linear_material(double kn, double ks, double friction, double density) {
    Material m;
    m.name = "grain";
    m.density = density;
    m.normal_stiffness = 2 * kn;
    m.shear_stiffness = 2 * ks;
    m.friction = friction;
    return m;
}

Material rigid_material(double friction) {
    Material m;
    m.name = "rigid";
    m.normal_stiffness = m.shear_stiffness = m.young_modulus = 1e30;
    m.friction = friction;
    m.rolling_friction = m.twisting_friction = 1e9;
    return m;
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
            const double n = p.force.normal_force, shear = std::sqrt(std::max(0.0, force.squaredNorm() - n * n));
            if (n > 0) t.friction_ratio = std::max(t.friction_ratio, shear / n);
        }
    });
    return t;
}

double free_kinetic_energy(World& world, EntityId body) {
    const Vec3& w = value_of<Spin>(world, body);
    return 0.5 * (value_of<InertialMass>(world, body) * value_of<Velocity>(world, body).squaredNorm() +
                  w.dot(angular_momentum(world, body, w)));
}

} // namespace bris
