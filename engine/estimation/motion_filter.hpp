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

/// Result of one observation.
struct ObservationResult {
    bool accepted = false;
    /// Normalised innovation squared: chi-squared with three degrees of freedom if the filter is
    /// consistent.
    double squared_distance = 0;
    Vec3 innovation = Vec3::Zero();
};

/// Estimates the motion of a rigid body: an error-state Kalman filter (position, velocity,
/// rotation, angular velocity, all in world axes: 12 numbers) about a nominal state with a unit
/// quaternion. After each update the rotation error is folded into the quaternion (Lefferts,
/// Markley and Shuster 1982; Sola 2017, arXiv 1711.02508), so no attitude is singular.
class MotionFilter {
public:
    static constexpr int size = 12;
    /// First index of each part of the error.
    enum Part { position = 0, velocity = 3, rotation = 6, angular_velocity = 9 };

    RigidState state;
    /// Largest normalised innovation squared of an accepted observation; 0: every observation is
    /// accepted.
    double gate = 0;

    /// Sets the standard deviations of the four parts of the error, the same for each axis.
    void begin(double position_m, double velocity_m_s, double rotation_rad,
               double angular_velocity_rad_s);

    /// Transition of the error in free motion over dt (s) at the angular velocity `rate` (rad/s),
    /// with the noise densities of advance().
    static Transition free_motion(double dt, const Vec3& rate, double acceleration_density,
                                  double angular_density);
    /// Predicts free motion over dt (s) under white noise of the linear and the angular
    /// acceleration, with densities in (m/s2)2/Hz and (rad/s2)2/Hz.
    void advance(double dt, double acceleration_density, double angular_density);
    /// Replaces the state by the forecast of another model and adds the model's error covariance
    /// `noise` (12 x 12) to the covariance.
    void move_to(const RigidState& forecast, const Matrix& noise);

    ObservationResult observe_position(const Vec3& y, const Mat3& covariance);
    ObservationResult observe_velocity(const Vec3& y, const Mat3& covariance);
    ObservationResult observe_attitude(const Quat& y, const Mat3& covariance);
    ObservationResult observe_angular_velocity(const Vec3& y,
                                               const Mat3& covariance); ///< world frame

    Matrix covariance() const { return error_.covariance(); }
    const Gaussian& error() const { return error_; }
    /// Restores the covariance from its root, as returned by error().
    void restore(const Gaussian& error) { error_ = error; }

private:
    ObservationResult observe(Part part, const Vec3& innovation, const Mat3& covariance);
    void fold(const Vector& error);
    Gaussian error_{size};
};

} // namespace bris
