#pragma once

#include "engine/math.hpp"

#include <cstdint>

namespace bris {

/// Free motion of a rigid body with principal moments I1 <= I2 <= I3: Jacobi's solution. Spin in
/// the body's axes by elliptic functions (Landau and Lifshitz, Mechanics, section 37), to rounding.
class FreeTop {
public:
    /// Moments in kg m2, spin at t = 0 in the body's axes, rad/s. Throws InputError for moments
    /// that are not ascending and above 0, for three equal ones, and for a spin on the separatrix
    /// or about one axis alone.
    FreeTop(const Vec3& inertia, const Vec3& angular_velocity);
    /// rad/s, in the body's axes.
    Vec3 angular_velocity(double time) const;
    /// The attitude at a time (s) when it was 1 at t = 0: the exact spin integrated by Magnus'
    /// fourth order with `steps` Gauss steps; error below 1e-12 rad at 0.005 rad a step.
    Quat attitude(double time, int steps) const;
    double period() const; ///< s, of the spin

private:
    Vec3 amplitude_;
    int circled_;             // axis that the angular momentum circles: 0 or 2
    double rate_, m_, begin_; // of the argument, parameter, argument at t = 0
};

/// A rigid body that turns freely.
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
    double angular_velocity_error = 0; ///< rad/s, against Jacobi at the end
    double attitude_error = 0;         ///< rad; nan after more than 1000 rad
    double momentum_drift = 0;         ///< |L - L0| / L0 at the end
    double energy_drift = 0;           ///< largest |E / E0 - 1|
    double norm_drift = 0;             ///< largest ||q| - 1|
};

/// Runs the top with the engine's rotation: fourth order in the angle of a step.
TopResult run_experiment(const Top& top);

/// A clump that swings about one of its balls, which lies in a groove of two smooth planes at right
/// angles: the ball's centre stays, and smooth contacts have no torque about it. A compound
/// pendulum.
struct Pendulum {
    double arm = 0.1;               ///< m, from the centre of mass to the ball's centre, > 0
    double radius = 0.01;           ///< m, of the ball
    double mass = 1;                ///< kg
    Vec3 inertia{2e-3, 3e-3, 4e-3}; ///< kg m2, principal; it swings about y
    double amplitude = 0.2;         ///< rad, below pi/4
    double gravity = 9.81;          ///< m/s2
    double stiffness_ratio = 1e6;   ///< stiffness of a contact times arm over weight
    double step_share = 0.1;        ///< dt over sqrt(m/k)
    unsigned swings = 2;
};

struct PendulumResult {
    double period = 0;          ///< s
    double exact_period = 0;    ///< s: 4 sqrt((I + m a^2) / (m g a)) K(sin(amplitude / 2))
    double amplitude_drift = 0; ///< of the last turning point, against the first
    double pivot_travel = 0;    ///< of the arm: how far the ball's centre went
    std::uint64_t steps = 0;
};
PendulumResult run_experiment(const Pendulum& pendulum);

} // namespace bris
