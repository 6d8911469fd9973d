#pragma once

#include "components/body.hpp"
#include "engine/clock.hpp"
#include "engine/random_vector.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/fusion/sensor_filter.hpp"

namespace bris {

inline constexpr double position_deviation = 1e-5, velocity_deviation = 1e-2,
                        attitude_deviation = 1e-2; // m, m/s and rad/s, rad

/// Measurement of all quantities of a body at the end of the last step, with noise of the standard
/// deviations above.
inline Measured observed(Simulation& sim, EntityId body, Random& random) {
    const auto noise = [&](double deviation) -> Vec3 { return deviation * normal_vector(random); };
    const double half_step = 0.5 * sim.world().resource<Clock>().dt;
    Measured m;
    m.position_deviation = position_deviation;
    m.velocity_deviation = m.angular_velocity_deviation = velocity_deviation;
    m.attitude_deviation = attitude_deviation;
    m.position = value_of<Position>(sim, body) + noise(position_deviation);
    m.velocity = value_of<Velocity>(sim, body) + half_step * value_of<Acceleration>(sim, body) +
                 noise(velocity_deviation);
    m.angular_velocity = value_of<AngularVelocity>(sim, body) + noise(velocity_deviation);
    m.attitude = exponential_map(noise(attitude_deviation)) * value_of<Orientation>(sim, body);
    return m;
}

} // namespace bris
