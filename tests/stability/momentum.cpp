// S16: without external forces momentum and angular momentum are conserved.
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

struct Momentum {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero(); // kg m/s, kg m2/s about the origin
    // sums of |p|, and of |x| |p| and |L|, to which rounding is relative
    double linear_sum = 0, angular_sum = 0;
};

Momentum momentum_of(const World& world) {
    const Table& bodies = world.table<Bodies>();
    Momentum m;
    for (Row b = 0; b < bodies.size(); ++b) {
        const Vec3 p = bodies.column<Mass>()[b] * bodies.column<Velocity>()[b];
        const Vec3 l = bodies.column<Position>()[b].cross(p) + bodies.column<AngularMomentum>()[b];
        m.linear += p;
        m.angular += l;
        m.linear_sum += p.norm();
        m.angular_sum += bodies.column<Position>()[b].norm() * p.norm() +
                         bodies.column<AngularMomentum>()[b].norm();
    }
    return m;
}

} // namespace

StressRows stress_momentum(const StressSettings& s) {
    StressRows rows;
    const unsigned steps = s.full ? 100'000 : 10'000;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) {
        World world = tumbling({.grains = grains,
                                .bodies = grains == Grains::spheres ? 64u : 27u,
                                .seed = s.seed,
                                .walls = false});
        world.resource<Gravity>().value.setZero();
        Vec3 centre = Vec3::Zero();
        const auto position = world.column<Bodies, Position>();
        for (const Vec3& x : position) centre += x / static_cast<double>(position.size());
        for (std::size_t b = 0; b < position.size(); ++b) { // move inwards, for many collisions
            world.column<Bodies, Velocity>()[b] += 30 * (centre - position[b]) + Vec3(0, 0, 0.5);
            position[b] -= centre;
        }
        const Momentum before = momentum_of(world);
        Simulation simulation =
            begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
        double linear = 0, angular = 0;
        for (int k = 0; k < 20; ++k) {
            simulation.advance(steps / 20);
            const Momentum now = momentum_of(simulation.world());
            linear = std::max(linear, (now.linear - before.linear).norm() / before.linear_sum);
            angular = std::max(angular, (now.angular - before.angular).norm() / now.angular_sum);
        }
        const char* what = grains == Grains::spheres ? "spheres" : "clumps";
        rows.push_back({"S16", fmt::format("{} collide without walls: momentum", what),
                        fmt::format("drift < 1e-12 of the sum of |p| in {} steps", steps),
                        fmt::format("{:.2e}", linear), linear < 1e-12});
        rows.push_back(
            {"S16", fmt::format("{} collide without walls: angular momentum", what),
             fmt::format("drift < 1e-12 of the sum of |x| |p| and |L| in {} steps", steps),
             fmt::format("{:.2e}", angular), angular < 1e-12});
    }
    return rows;
}

} // namespace bris
