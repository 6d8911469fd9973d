#include "scenarios/specimens/true_masses.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"

#include <algorithm>

namespace bris {

double restore_masses(World& world) {
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto mass = bodies.column<Mass>();
    const auto inertia = bodies.column<Inertia>();
    const auto inertial = bodies.column<InertialMass>();
    const auto inertial_inertia = bodies.column<InertialInertia>();
    const auto velocity = bodies.column<Velocity>();
    const auto momentum = bodies.column<AngularMomentum>();
    const auto angular_velocity = bodies.column<AngularVelocity>();
    const auto work =
        bodies.has<ScalingWork>() ? bodies.column<ScalingWork>() : std::span<double>();
    for (Row b = 0; b < bodies.size(); ++b) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        // all components of the inertia were scaled by one factor
        const double turning = inertia[b].x() / inertial_inertia[b].x();
        if (!work.empty())
            work[b] += 0.5 * (mass[b] - inertial[b]) * velocity[b].squaredNorm() +
                       0.5 * (turning - 1) * momentum[b].dot(angular_velocity[b]);
        momentum[b] *= turning;
        inertial[b] = mass[b];
        inertial_inertia[b] = inertia[b];
    }
    show_velocities(world); // and masses: see scale_masses
    return std::min(stable_step(world), stable_step_of_first_contact(world));
}

} // namespace bris
