#include "engine/estimation/motion_filter.hpp"

#include <array>

namespace bris {

namespace {

Transition at_rest() {
    return {Matrix::Identity(MotionFilter::size, MotionFilter::size),
            Matrix::Zero(MotionFilter::size, MotionFilter::size)};
}

} // namespace

void MotionFilter::begin(double position_m, double velocity_m_s, double rotation_rad,
                         double angular_velocity_rad_s) {
    const std::array deviations{position_m, velocity_m_s, rotation_rad, angular_velocity_rad_s};
    error_ = Gaussian(size);
    for (int k = 0; k < size; ++k) error_.root(k, k) = deviations[static_cast<std::size_t>(k / 3)];
}

Transition MotionFilter::free_motion(double dt, const Vec3& rate, double acceleration_density,
                                     double angular_density) {
    const Vec3 turn = dt * rate;
    Transition t = at_rest();
    const Mat3 one = Mat3::Identity();
    t.F.block<3, 3>(position, velocity) = dt * one;
    t.F.block<3, 3>(rotation, rotation) = exponential_map(turn).toRotationMatrix();
    t.F.block<3, 3>(rotation, angular_velocity) = dt * mean_rotation(turn);
    const auto drive = [&](int first, int second, double density) {
        t.Q.block<3, 3>(first, first) = density * dt * dt * dt / 3 * one;
        t.Q.block<3, 3>(first, second) = t.Q.block<3, 3>(second, first) =
            density * dt * dt / 2 * one;
        t.Q.block<3, 3>(second, second) = density * dt * one;
    };
    drive(position, velocity, acceleration_density);
    drive(rotation, angular_velocity, angular_density);
    return t;
}

void MotionFilter::advance(double dt, double acceleration_density, double angular_density) {
    error_ = predict(
        error_, free_motion(dt, state.angular_velocity, acceleration_density, angular_density));
    const Vec3 turn = dt * state.angular_velocity;
    state.position += dt * state.velocity;
    state.orientation = (exponential_map(turn) * state.orientation).normalized();
}

void MotionFilter::move_to(const RigidState& forecast, const Matrix& noise) {
    Transition t = at_rest();
    t.Q = noise;
    error_ = predict(error_, t);
    state = forecast;
}

ObservationResult MotionFilter::observe_position(const Vec3& y, const Mat3& covariance) {
    return observe(position, y - state.position, covariance);
}

ObservationResult MotionFilter::observe_velocity(const Vec3& y, const Mat3& covariance) {
    return observe(velocity, y - state.velocity, covariance);
}

ObservationResult MotionFilter::observe_attitude(const Quat& y, const Mat3& covariance) {
    return observe(rotation, attitude_error(y, state.orientation), covariance);
}

ObservationResult MotionFilter::observe_angular_velocity(const Vec3& y, const Mat3& covariance) {
    return observe(angular_velocity, y - state.angular_velocity, covariance);
}

ObservationResult MotionFilter::observe(Part part, const Vec3& innovation, const Mat3& covariance) {
    Matrix H = Matrix::Zero(3, size);
    H.block<3, 3>(0, part).setIdentity();
    const auto c = correct<double>(error_, innovation, H, covariance);
    const bool accepted =
        std::isfinite(c.squared_distance) && (gate <= 0 || c.squared_distance <= gate);
    if (accepted) {
        error_ = c.estimate;
        fold(error_.mean);
    }
    return {accepted, c.squared_distance, innovation};
}

// The covariance is not changed, and no rotation of its axes gives information on yaw.
void MotionFilter::fold(const Vector& error) {
    const Vec3 turn = error.segment<3>(rotation);
    state.position += error.segment<3>(position);
    state.velocity += error.segment<3>(velocity);
    state.orientation = (exponential_map(turn) * state.orientation).normalized();
    state.angular_velocity += error.segment<3>(angular_velocity);
    error_.mean.setZero();
}

} // namespace bris
