#pragma once

#include "engine/estimation/kalman.hpp"
#include "engine/signal/attitude.hpp"

namespace bris {

/// A rigid body's motion at one time.
struct RigidState {
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(); ///< m and m/s, world frame
    Quat orientation = Quat::Identity();                   ///< from the body's axes to the world's
    Vec3 angular_velocity = Vec3::Zero();                  ///< rad/s, world frame
};

/// What an inertial sensor tells in one sample, in the body's axes and at its centre.
struct InertialSample {
    Vec3 specific_force; ///< m/s2: acceleration less gravity
    Vec3 rate;           ///< rad/s
};

/// White noise of a sample, and what drives its biases.
struct InertialNoise {
    double force = 0, rate = 0;                     ///< m/s2/sqrt(Hz), rad/s/sqrt(Hz)
    double force_bias_walk = 0, rate_bias_walk = 0; ///< m/s3/sqrt(Hz), rad/s2/sqrt(Hz)
};

/// Result of an observation.
struct Verdict {
    bool accepted = false;
    double squared_distance = 0; ///< chi square of three degrees, if the filter is consistent
    Vec3 innovation = Vec3::Zero();
};

/// Estimates motion, attitude and the biases of an inertial sensor: a Kalman filter of the error
/// (position, velocity, rotation, spin, all in the world's axes, bias of force, bias of rate: 18
/// numbers) about a nominal state with a unit quaternion, into which its rotation is folded after
/// each update (Lefferts, Markley and Shuster 1982; Sola 2017, arXiv 1711.02508). No attitude is
/// singular. In the world's axes gravity tells nothing of yaw wherever the estimate stands; in the
/// body's it would seem to (Barrau and Bonnabel 2017).
class InertialFilter {
public:
    static constexpr int size = 18;
    /// Where the parts of the error begin.
    enum Part {
        position = 0,
        velocity = 3,
        rotation = 6,
        angular_velocity = 9,
        force_bias = 12,
        rate_bias = 15
    };

    RigidState state;
    Vec3 bias_of_force = Vec3::Zero(), bias_of_rate = Vec3::Zero();
    Vec3 gravity = Vec3::Zero(); ///< m/s2, world frame
    double gate = 0;             ///< largest squared distance of an observation; 0: none is refused

    /// Standard deviations of the six parts, the same for each axis.
    void begin(double position_m, double velocity_m_s, double rotation_rad,
               double angular_velocity_rad_s, double force_bias_m_s2, double rate_bias_rad_s);

    /// What free motion over dt (s) at a rate of turning (rad/s) makes of the error, and the noise
    /// densities of advance() add to it.
    static Transition free_motion(double dt, const Vec3& rate, double acceleration_density,
                                  double angular_density);
    /// Free motion over dt (s) under white noise of linear and angular acceleration, (m/s2)2/Hz and
    /// (rad/s2)2/Hz.
    void advance(double dt, double acceleration_density, double angular_density);
    /// Motion over dt as the sensor measured it.
    void advance(double dt, const InertialSample& sample, const InertialNoise& noise);
    /// Biases walk over dt; the rest stays.
    void age_biases(double dt, const InertialNoise& noise);
    /// Puts the state where another model sees it, whose own error adds to the covariance: `noise`
    /// (12 x 12) of the first four parts.
    void move_to(const RigidState& forecast, const Matrix& noise);

    Verdict observe_position(const Vec3& y, const Mat3& covariance);
    Verdict observe_velocity(const Vec3& y, const Mat3& covariance);
    Verdict observe_attitude(const Quat& y, const Mat3& covariance);
    Verdict observe_angular_velocity(const Vec3& y, const Mat3& covariance); ///< world frame
    /// The specific force at `arm` (m, body's axes) of a body whose centre has the `acceleration`
    /// (m/s2, world frame).
    Verdict observe_force(const Vec3& y, const Vec3& acceleration, const Vec3& arm,
                          const Mat3& covariance);
    Verdict observe_rate(const Vec3& y, const Mat3& covariance);
    /// A vector of the world, such as the earth's magnetic field, seen in the body's axes.
    Verdict observe_vector(const Vec3& y, const Vec3& in_world, const Mat3& covariance);

    Matrix covariance() const { return error_.covariance(); }
    const Gaussian& error() const { return error_; }
    /// Sets the covariance by its root, as error() gave it.
    void restore(const Gaussian& error) { error_ = error; }

private:
    Verdict observe(const Vec3& innovation, const Matrix& H, const Mat3& covariance);
    void fold(const Vector& error);
    Gaussian error_{size};
};

} // namespace bris
