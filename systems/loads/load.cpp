#include "systems/loads/load.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"

namespace bris {

namespace {

/// Adds the loads on bodies to their forces, with the histories at the time of the positions.
void apply_loads(Rows<Bodies, const LoadOf, const Orientation, Force, Torque, LoadForce> bodies,
                 const Loads& loads, const Clock& clock) {
    const std::uint32_t* number = bodies.column<LoadOf>();
    const Quat* orientation = bodies.column<Orientation>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    Wrench* total = bodies.column<LoadForce>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        Wrench sum;
        for (const Load& load : loads.of_body[number[b] - 1]) {
            const double now = load.history.at(clock.time());
            sum.force += now * load.force;
            sum.torque += now * (load.couple + (orientation[b] * load.point).cross(load.force));
        }
        force[b] += sum.force;
        torque[b] += sum.torque;
        total[b] = sum;
    }
}

void accumulate_load_work(Rows<Bodies, const LoadOf, const LoadForce, const Force, const Torque,
                               const Velocity, const AngularMomentum, const InertialMass,
                               const InertialInertia, const Orientation, LoadWork>
                              bodies,
                          const Clock& clock) {
    const std::uint32_t* number = bodies.column<LoadOf>();
    const Wrench* load = bodies.column<LoadForce>();
    double* work = bodies.column<LoadWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        const MeanMotion mean = mean_motion(bodies, b, clock.dt);
        work[b] += clock.dt *
                   (load[b].force.dot(mean.velocity) + load[b].torque.dot(mean.angular_velocity));
    }
}

} // namespace

StepList Loads::force_systems() { return {row_local("apply_loads", apply_loads)}; }
StepList Loads::work_systems() { return {row_local("accumulate_load_work", accumulate_load_work)}; }

void add_load(World& world, EntityId body, const Load& load) {
    const Row row = row_of_free_clump(world, body, "load");
    const LoadHistory& h = load.history;
    require(h.times.size() == h.values.size() &&
                std::adjacent_find(h.times.begin(), h.times.end(), std::greater_equal<>()) ==
                    h.times.end(),
            "load: expected a table of ascending times with a value for each");
    if (!world.has_resource<Loads>()) world.add_resource<Loads>();
    world.resource<Loads>().list<LoadOf>(world, row).push_back(load);
    world.table<Bodies>().add<LoadForce>();
}

} // namespace bris
