#include "systems/loads/spring_patch.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/exact_sum.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// The point of a patch and its speed along the patch's axis at the time of the positions.
struct PatchAt {
    Vec3 arm;
    double displaced, speed;
};

template <class BodyRows>
PatchAt locate(const BodyRows& bodies, Row b, const SpringPatch& p, double dt) {
    const Vec3 arm = bodies.template column<Orientation>()[b] * p.point;
    return {arm, p.displacement(bodies.template column<Position>()[b] + arm),
            point_velocity(bodies, b, arm, dt).dot(p.axis)};
}

/// Adds the forces of springs and dashpots between bodies and the ground.
void push_patches(Rows<Bodies, const PatchesOf, const Position, const Velocity, const Acceleration,
                       const AngularVelocity, const Orientation, Force, Torque, PatchForce>
                      bodies,
                  const SpringPatches& patches, const Clock& clock) {
    const std::uint32_t* number = bodies.column<PatchesOf>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    Wrench* total = bodies.column<PatchForce>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        Wrench sum;
        for (const SpringPatch& p : patches.of_body[number[b] - 1]) {
            const PatchAt at = locate(bodies, b, p, clock.dt);
            const Vec3 f = p.force(at.displaced, at.speed) * p.axis;
            sum.force += f;
            sum.torque += at.arm.cross(f);
        }
        force[b] += sum.force;
        torque[b] += sum.torque;
        total[b] = sum;
    }
}

void accumulate_patch_work(
    Rows<Bodies, const PatchesOf, const Position, const Force, const Torque, const Velocity,
         const Acceleration, const AngularVelocity, const AngularMomentum, const InertialMass,
         const InertialInertia, const Orientation, PatchWork>
        bodies,
    const SpringPatches& patches, const Clock& clock) {
    const std::uint32_t* number = bodies.column<PatchesOf>();
    double* work = bodies.column<PatchWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        const MeanMotion mean = mean_motion(bodies, b, clock.dt);
        for (const SpringPatch& p : patches.of_body[number[b] - 1]) {
            const PatchAt at = locate(bodies, b, p, clock.dt);
            // what the patch exerts beyond its spring is the dashpot's
            const double damping = p.force(at.displaced, at.speed) - p.force(at.displaced, 0);
            const Vec3 moved = mean.velocity + mean.angular_velocity.cross(at.arm);
            work[b] -= clock.dt * damping * moved.dot(p.axis);
        }
    }
}

} // namespace

StepList SpringPatches::force_systems() { return {row_local("push_patches", push_patches)}; }
StepList SpringPatches::work_systems() {
    return {row_local("accumulate_patch_work", accumulate_patch_work)};
}

double SpringPatches::energy(const World& world) {
    ExactSum energy;
    for (Row b = 0; b < world.table<Bodies>().size(); ++b) energy.add(patch_energy(world, b));
    return energy.value();
}

void SpringPatches::add_springs(const World& world, std::vector<BodySpring>& springs) {
    const auto number = world.column<Bodies, PatchesOf>();
    const auto orientation = world.column<Bodies, Orientation>();
    for (Row b = 0; b < number.size(); ++b) {
        if (number[b] == 0) continue;
        for (const SpringPatch& p : world.resource<SpringPatches>().of_body[number[b] - 1])
            springs.push_back({b, p.stiffness, p.damping, orientation[b] * p.point, p.axis});
    }
}

void add_patch(World& world, EntityId body, const SpringPatch& patch) {
    const Row row = row_of_free_clump(world, body, "spring-dashpot patch");
    require(patch.stiffness >= 0 && patch.damping >= 0 && std::abs(patch.axis.norm() - 1) < 1e-12,
            fmt::format("spring-dashpot patch: expected a stiffness and a damping of at least 0 "
                        "and an axis of length 1, found {:g} N/m, {:g} N s/m and {:g}",
                        patch.stiffness, patch.damping, patch.axis.norm()));
    if (!world.has_resource<SpringPatches>()) world.add_resource<SpringPatches>();
    world.resource<SpringPatches>().list<PatchesOf>(world, row).push_back(patch);
    world.table<Bodies>().add<PatchForce>();
}

void add_guide(World& world, EntityId body, const Vec3& point, const Vec3& axis, double stiffness,
               double damping) {
    const Row row = row_of_free_clump(world, body, "spring-dashpot patch");
    add_patch(world, body,
              {.point = point,
               .anchor = world.column<Bodies, Position>()[row] + point,
               .axis = axis,
               .stiffness = stiffness,
               .damping = damping});
}

double patch_energy(const World& world, Row body) {
    const Table& bodies = world.table<Bodies>();
    const std::uint32_t number = bodies.has<PatchesOf>() ? bodies.column<PatchesOf>()[body] : 0;
    if (number == 0) return 0;
    double energy = 0;
    for (const SpringPatch& p : world.resource<SpringPatches>().of_body[number - 1])
        energy += p.energy(p.displacement(bodies.column<Position>()[body] +
                                          bodies.column<Orientation>()[body] * p.point));
    return energy;
}

} // namespace bris
