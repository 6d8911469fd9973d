#pragma once

#include "engine/estimation/kalman.hpp"
#include "engine/signal/attitude.hpp"

namespace bris {

/// Motion of a rigid body at one time.
struct RigidState {
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(); ///< m and m/s, world frame
    Quat orientation = Quat::Identity();                   ///< from the body's axes to the world's
    Vec3 angular_velocity = Vec3::Zero();                  ///< rad/s, world frame
};

/// One sample of an inertial sensor, at its centre and in the axes of the body.
struct InertialSample {
    Vec3 specific_force; ///< m/s2: acceleration minus gravity
    Vec3 rate;           ///< rad/s
};

/// Noise densities of an inertial sensor: white noise of its samples, and of the random walk of its
/// biases.
struct InertialNoise {
    double force = 0, rate = 0;                     ///< m/s2/sqrt(Hz), rad/s/sqrt(Hz)
    double force_bias_walk = 0, rate_bias_walk = 0; ///< m/s3/sqrt(Hz), rad/s2/sqrt(Hz)
};

/// Result of one observation.
struct Verdict {
    bool accepted = false;
    /// Normalised innovation squared: chi-squared with three degrees of freedom if the filter is
    /// consistent.
    double squared_distance = 0;
    Vec3 innovation = Vec3::Zero();
};

/// Estimates motion, attitude and sensor biases from an inertial sensor: an error-state Kalman
/// filter (position, velocity, rotation, angular velocity, all in world axes, force bias, rate
/// bias: 18 numbers) about a nominal state with a unit quaternion. After each update the rotation
/// error is folded into the quaternion (Lefferts, Markley and Shuster 1982; Sola 2017, arXiv
/// 1711.02508), so no attitude is singular. With the errors in world axes, gravity gives no
/// information on yaw at any estimate; with errors in body axes it would appear to (Barrau and
/// Bonnabel 2017).
class InertialFilter {
public:
    static constexpr int size = 18;
    /// First index of each part of the error.
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
    /// Largest normalised innovation squared of an accepted observation; 0: every observation is
    /// accepted.
    double gate = 0;

    /// Sets the standard deviations of the six parts of the error, the same for each axis.
    void begin(double position_m, double velocity_m_s, double rotation_rad,
               double angular_velocity_rad_s, double force_bias_m_s2, double rate_bias_rad_s);

    /// Transition of the error in free motion over dt (s) at the angular velocity `rate` (rad/s),
    /// with the noise densities of advance().
    static Transition free_motion(double dt, const Vec3& rate, double acceleration_density,
                                  double angular_density);
    /// Predicts free motion over dt (s) under white noise of the linear and the angular
    /// acceleration, with densities in (m/s2)2/Hz and (rad/s2)2/Hz.
    void advance(double dt, double acceleration_density, double angular_density);
    /// Predicts the motion over dt (s) by integrating the sample.
    void advance(double dt, const InertialSample& sample, const InertialNoise& noise);
    /// Predicts the random walk of the biases over dt (s); the rest of the state does not change.
    void age_biases(double dt, const InertialNoise& noise);
    /// Replaces the state by the forecast of another model and adds the model's error covariance
    /// `noise` (12 x 12, of the first four parts) to the covariance.
    void move_to(const RigidState& forecast, const Matrix& noise);

    Verdict observe_position(const Vec3& y, const Mat3& covariance);
    Verdict observe_velocity(const Vec3& y, const Mat3& covariance);
    Verdict observe_attitude(const Quat& y, const Mat3& covariance);
    Verdict observe_angular_velocity(const Vec3& y, const Mat3& covariance); ///< world frame
    /// The specific force at `arm` (m, from the body's centre, in body axes) of a body whose centre
    /// has the given `acceleration` (m/s2, world frame).
    Verdict observe_force(const Vec3& y, const Vec3& acceleration, const Vec3& arm,
                          const Mat3& covariance);
    Verdict observe_rate(const Vec3& y, const Mat3& covariance);
    /// A vector that is known in the world frame, such as the earth's magnetic field, measured in
    /// body axes.
    Verdict observe_vector(const Vec3& y, const Vec3& in_world, const Mat3& covariance);

    Matrix covariance() const { return error_.covariance(); }
    const Gaussian& error() const { return error_; }
    /// Restores the covariance from its root, as returned by error().
    void restore(const Gaussian& error) { error_ = error; }

private:
    Verdict observe(const Vec3& innovation, const Matrix& H, const Mat3& covariance);
    void fold(const Vector& error);
    Gaussian error_{size};
};

} // namespace bris
