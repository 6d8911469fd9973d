#pragma once

#include "engine/math.hpp"

#include <cstdint>

namespace bris {

/// Jacobi's solution of the torque-free motion of a rigid body with principal moments I1 <= I2 <=
/// I3. The angular velocity in the body's axes follows from elliptic functions (Landau and
/// Lifshitz, Mechanics, section 37), exact to rounding.
class FreeTop {
public:
    /// Takes the moments in kg m2 and the angular velocity at t = 0 in the body's axes in rad/s.
    /// Throws InputError for moments that are not ascending and above 0, for three equal moments,
    /// and for an angular velocity on the separatrix or about one axis only.
    FreeTop(const Vec3& inertia, const Vec3& angular_velocity);
    /// Angular velocity in the body's axes, rad/s, at a time (s).
    Vec3 angular_velocity(double time) const;
    /// Attitude at a time (s) for the identity attitude at t = 0. It is the integral of the exact
    /// angular velocity by the Magnus method of fourth order with `steps` Gauss steps. Error below
    /// 1e-12 rad at 0.005 rad per step.
    Quat attitude(double time, int steps) const;
    double period() const; ///< s, period of the angular velocity

private:
    Vec3 amplitude_;
    int circled_;             // axis that the angular momentum circles: 0 or 2
    double rate_, m_, begin_; // rate of the argument, parameter, argument at t = 0
};

/// A rigid body that rotates without torque.
struct Top {
    Vec3 inertia{1, 2, 3};          ///< kg m2, ascending, above 0
    Vec3 angular_velocity{1, 0, 1}; ///< rad/s, in the body's axes
    double angle_per_step = 0.05;   ///< rad, > 0
    double duration = 10;           ///< s, > 0; rounded to whole steps
};

struct TopResult {
    double dt = 0; ///< s
    std::uint64_t steps = 0;
    Vec3 angular_velocity = Vec3::Zero(); ///< rad/s, in the body's axes, at the end
    Quat attitude{1, 0, 0, 0};
    double angular_velocity_error = 0; ///< rad/s, difference to Jacobi's solution at the end
    double attitude_error = 0;         ///< rad, at the end; NaN after more than 1000 rad
    double momentum_drift = 0;         ///< |L - L0| / L0 at the end
    double energy_drift = 0;           ///< largest |E / E0 - 1|
    double norm_drift = 0;             ///< largest ||q| - 1|
};

/// Throws InputError for a step or duration that is not above 0, or where FreeTop does.
void check(const Top& top);
/// Runs the top with the engine's integration of rotation. Fourth order in the angle of a step.
/// Throws as check.
TopResult run_experiment(const Top& top);

/// A compound pendulum: a clump that swings about one of its spheres, which lies in a groove of two
/// smooth planes at right angles. The centre of this sphere stays in place, and smooth contacts
/// have no torque about it.
struct Pendulum {
    double arm = 0.1;               ///< m, from the centre of mass to the centre of the sphere, > 0
    double radius = 0.01;           ///< m, of the sphere
    double mass = 1;                ///< kg
    Vec3 inertia{2e-3, 3e-3, 4e-3}; ///< kg m2, principal moments; the pendulum swings about y
    double amplitude = 0.2;         ///< rad, below pi/4
    double gravity = 9.81;          ///< m/s2
    double stiffness_ratio = 1e6;   ///< contact stiffness times arm over weight
    double step_share = 0.1;        ///< dt / sqrt(m/k)
    unsigned swings = 2;            ///< number of full swings
};

struct PendulumResult {
    double period = 0;          ///< s
    double exact_period = 0;    ///< s: 4 sqrt((I + m a^2) / (m g a)) K(sin(amplitude / 2))
    double amplitude_drift = 0; ///< relative change from the first turning point to the last
    double pivot_travel = 0;    ///< largest displacement of the sphere's centre, relative to arm
    std::uint64_t steps = 0;
};
/// Throws InputError for an amplitude out of range.
void check(const Pendulum& pendulum);
/// Runs the experiment. Throws as check, and SimulationError if the pendulum does not swing.
PendulumResult run_experiment(const Pendulum& pendulum);

} // namespace bris
