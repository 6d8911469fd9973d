#include "tests/verification/guided_pair.hpp"

#include "scenarios/specimens/small_scene.hpp"

#include <cmath>

namespace bris {

namespace {

constexpr EntityId heavy = 0, led = 1;

Simulation make_pair(const GuidedPair::Settings& s) {
    World world = make_world(Grains::spheres);
    Material m = s.material;
    m.density = 1e30; // so heavy that no force moves it
    const auto material = world.resource<Materials>().add(m);
    world.resource<Materials>().policy = s.policy;
    world.resource<Materials>().mix();
    if (!traits(s.law).of_pairs.empty())
        world.resource<Materials>().set_own(s.law, material, material, s.own);
    const double heavy_radius = s.heavy_radius > 0 ? s.heavy_radius : s.radius;
    add_sphere(world, Vec3::Zero(), heavy_radius, material);
    add_sphere(world, Vec3(0, 0, heavy_radius + s.radius - s.overlap), s.radius, material,
               Motion::prescribed);
    return begin(std::move(world), {.dt = s.dt, .law = s.law, .unlimited = true});
}

} // namespace

GuidedPair::GuidedPair(const Settings& settings)
    : simulation_(make_pair(settings)), dt_(settings.dt) {}

GuidedPair::Answer GuidedPair::step(const Vec3& shift, const Vec3& turn, const Vec3& heavy_turn) {
    World& world = simulation_.world();
    value_of<DriveVelocity>(world, led) = shift / dt_;
    // angular velocities of the coming displacement, which are read with the new positions
    value_of<AngularVelocity>(world, led) = value_of<StepAngularVelocity>(world, led) = turn / dt_;
    set_angular_velocity(world, heavy, heavy_turn / dt_);
    simulation_.advance();
    return {value_of<Force>(world, heavy), value_of<Torque>(world, heavy),
            touch_of(world).normal_force};
}

Vec3 GuidedPair::position() const {
    const auto ids = simulation_.world().column<Bodies, BodyId>();
    return simulation_.world().column<Bodies, Position>()[ids[0] == led ? 0 : 1];
}

ShearLoopResult run_experiment(const ShearLoop& s) {
    GuidedPair::Settings settings;
    settings.overlap = s.overlap;
    settings.material = linear_material(s.stiffness, s.shear_ratio * s.stiffness, s.friction);
    GuidedPair pair(settings);
    const double limit = s.friction * s.stiffness * s.overlap,
                 reach = 2 * settings.radius - s.overlap;
    // the guided sphere oscillates about its own centre: surfaces shear, centres stay in place
    const double arm = 0.5 * reach;
    ShearLoopResult r;
    r.exact = 4 * limit * (s.amplitude - limit / (s.shear_ratio * s.stiffness));
    const auto angle = [&](unsigned k) {
        return s.amplitude / arm * std::sin(2 * pi * k / s.steps);
    };
    double before = 0;
    for (unsigned k = 0; k <= 2 * s.steps; ++k) {
        const GuidedPair::Answer now = pair.step(Vec3::Zero(), Vec3(0, angle(k + 1) - angle(k), 0));
        // the lowest point of the guided sphere moves by -arm * turn along x
        if (k > s.steps)
            r.work += 0.5 * (now.force.x() + before) * -arm * (angle(k) - angle(k - 1));
        before = now.force.x();
        r.largest_ratio =
            std::max(r.largest_ratio, std::abs(now.force.x()) / (s.friction * now.normal_force));
    }
    return r;
}

RigidTurnResult run_experiment(const RigidTurn& s) {
    GuidedPair::Settings settings;
    settings.radius = s.radius;
    settings.overlap = 1e-3 * s.radius;
    settings.material = linear_material(1e6, 5e5, 1e12);
    GuidedPair pair(settings);
    const double arm = s.radius - 0.5 * settings.overlap;
    pair.step(Vec3::Zero(), Vec3(0.6, 0.8, 0) * s.stretch / arm);
    const Vec3 axis = s.axis.normalized(), turn = 2 * pi / s.steps * axis;
    const auto position = [&](unsigned k) {
        return exponential_map(2 * pi * k / s.steps * axis) *
               Vec3(0, 0, 2 * s.radius - settings.overlap);
    };
    Vec3 first = Vec3::Zero();
    RigidTurnResult r;
    for (unsigned k = 0; k <= s.steps; ++k) {
        const Vec3 n = position(k).normalized();
        const Vec3 shift =
            k < s.steps ? Vec3(position(k + 1) - pair.position()) : Vec3(Vec3::Zero());
        const Vec3 force = pair.step(shift, turn, turn).force, now = force - force.dot(n) * n;
        if (k == 0) first = now;
        r.length_drift = std::max(r.length_drift, std::abs(now.norm() / first.norm() - 1));
        r.angle = std::atan2(now.cross(first).norm(), now.dot(first));
    }
    return r;
}

double run_experiment(const RollAndTwist& s) {
    GuidedPair::Settings settings;
    settings.law = LawName::linear_rolling;
    settings.material =
        linear_material(1e6, 5e5, 0); // without friction only rolling and twisting give a torque
    settings.material.rolling_friction = s.rolling_friction;
    settings.material.twisting_friction = s.twisting_friction;
    GuidedPair pair(settings);
    GuidedPair::Answer answer{};
    const double angle = 1e-5;
    for (int k = 0; k < 2000; ++k)
        answer = pair.step(Vec3::Zero(), Vec3(s.roll ? angle : 0, 0, s.twist ? angle : 0));
    return answer.torque.norm() / (0.5 * settings.radius * answer.normal_force);
}

} // namespace bris
