#include "engine/estimation/inertial_filter.hpp"

namespace bris {

namespace {

Transition at_rest() {
    return {Matrix::Identity(InertialFilter::size, InertialFilter::size),
            Matrix::Zero(InertialFilter::size, InertialFilter::size)};
}

Matrix sees_nothing() { return Matrix::Zero(3, InertialFilter::size); }

Matrix observation_matrix(InertialFilter::Part part) {
    Matrix H = sees_nothing();
    H.block<3, 3>(0, part).setIdentity();
    return H;
}

} // namespace

void InertialFilter::begin(double position_m, double velocity_m_s, double rotation_rad,
                           double angular_velocity_rad_s, double force_bias_m_s2,
                           double rate_bias_rad_s) {
    Eigen::Matrix<double, 6, 1> deviations;
    deviations << position_m, velocity_m_s, rotation_rad, angular_velocity_rad_s, force_bias_m_s2,
        rate_bias_rad_s;
    error_ = Gaussian(size);
    for (int k = 0; k < size; ++k) error_.root(k, k) = deviations[k / 3];
}

Transition InertialFilter::free_motion(double dt, const Vec3& rate, double acceleration_density,
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

void InertialFilter::advance(double dt, double acceleration_density, double angular_density) {
    error_ = predict(
        error_, free_motion(dt, state.angular_velocity, acceleration_density, angular_density));
    const Vec3 turn = dt * state.angular_velocity;
    state.position += dt * state.velocity;
    state.orientation = (exponential_map(turn) * state.orientation).normalized();
}

void InertialFilter::advance(double dt, const InertialSample& sample, const InertialNoise& noise) {
    const Vec3 force = sample.specific_force - bias_of_force, rate = sample.rate - bias_of_rate,
               turn = dt * rate;
    const Mat3 R = state.orientation.toRotationMatrix(), one = Mat3::Identity();
    const Quat later = (state.orientation * exponential_map(turn)).normalized();
    const Vec3 specific_force = R * force, spun = later * rate;
    const Mat3 turned = dt * (R * mean_rotation(turn)), tilted = cross_matrix(specific_force);
    Transition t = at_rest();
    t.F.block<3, 3>(position, velocity) = dt * one;
    t.F.block<3, 3>(position, rotation) = -0.5 * dt * dt * tilted;
    t.F.block<3, 3>(position, force_bias) = -0.5 * dt * dt * R;
    t.F.block<3, 3>(velocity, rotation) = -dt * tilted;
    t.F.block<3, 3>(velocity, force_bias) = -dt * R;
    t.F.block<3, 3>(rotation, rate_bias) = -turned;
    // the sample determines the angular velocity afresh
    t.F.block<3, 3>(angular_velocity, angular_velocity).setZero();
    t.F.block<3, 3>(angular_velocity, rotation) = -cross_matrix(spun);
    t.F.block<3, 3>(angular_velocity, rate_bias) =
        cross_matrix(spun) * turned - later.toRotationMatrix();
    const double f2 = noise.force * noise.force, w2 = noise.rate * noise.rate;
    t.Q.block<3, 3>(position, position) = f2 * dt * dt * dt / 3 * one;
    t.Q.block<3, 3>(position, velocity) = t.Q.block<3, 3>(velocity, position) =
        f2 * dt * dt / 2 * one;
    t.Q.block<3, 3>(velocity, velocity) = f2 * dt * one;
    // the same noise rotates the body and enters its angular velocity
    t.Q.block<3, 3>(rotation, rotation) = w2 * dt * one;
    t.Q.block<3, 3>(rotation, angular_velocity) = t.Q.block<3, 3>(angular_velocity, rotation) =
        w2 * one;
    t.Q.block<3, 3>(angular_velocity, angular_velocity) = w2 / dt * one;
    error_ = predict(error_, t);
    age_biases(dt, noise);
    const Vec3 acceleration = specific_force + gravity;
    state.position += dt * state.velocity + 0.5 * dt * dt * acceleration;
    state.velocity += dt * acceleration;
    state.orientation = later;
    state.angular_velocity = spun;
}

void InertialFilter::age_biases(double dt, const InertialNoise& noise) {
    Transition t = at_rest();
    t.Q.block<3, 3>(force_bias, force_bias) =
        noise.force_bias_walk * noise.force_bias_walk * dt * Mat3::Identity();
    t.Q.block<3, 3>(rate_bias, rate_bias) =
        noise.rate_bias_walk * noise.rate_bias_walk * dt * Mat3::Identity();
    error_ = predict(error_, t);
}

void InertialFilter::move_to(const RigidState& forecast, const Matrix& noise) {
    Transition t = at_rest();
    t.Q.topLeftCorner<12, 12>() = noise;
    error_ = predict(error_, t);
    state = forecast;
}

Verdict InertialFilter::observe_position(const Vec3& y, const Mat3& covariance) {
    return observe(y - state.position, observation_matrix(position), covariance);
}

Verdict InertialFilter::observe_velocity(const Vec3& y, const Mat3& covariance) {
    return observe(y - state.velocity, observation_matrix(velocity), covariance);
}

Verdict InertialFilter::observe_attitude(const Quat& y, const Mat3& covariance) {
    return observe(attitude_error(y, state.orientation), observation_matrix(rotation), covariance);
}

Verdict InertialFilter::observe_angular_velocity(const Vec3& y, const Mat3& covariance) {
    return observe(y - state.angular_velocity, observation_matrix(angular_velocity), covariance);
}

Verdict InertialFilter::observe_force(const Vec3& y, const Vec3& acceleration, const Vec3& arm,
                                      const Mat3& covariance) {
    // computed in world axes, then rotated into body axes
    const Mat3 to_body = state.orientation.conjugate().toRotationMatrix();
    const Vec3 &w = state.angular_velocity, r = state.orientation * arm, swung = w.cross(r),
               force = acceleration - gravity + w.cross(swung);
    Matrix H = observation_matrix(force_bias);
    // second term: the arm rotates with the body
    H.block<3, 3>(0, rotation) =
        to_body * Mat3(cross_matrix(force) - cross_matrix(w) * cross_matrix(w) * cross_matrix(r));
    H.block<3, 3>(0, angular_velocity) =
        -to_body * Mat3(cross_matrix(swung) + cross_matrix(w) * cross_matrix(r));
    return observe(y - to_body * force - bias_of_force, H, covariance);
}

Verdict InertialFilter::observe_rate(const Vec3& y, const Mat3& covariance) {
    const Mat3 to_body = state.orientation.conjugate().toRotationMatrix();
    Matrix H = observation_matrix(rate_bias);
    H.block<3, 3>(0, rotation) = to_body * cross_matrix(state.angular_velocity);
    H.block<3, 3>(0, angular_velocity) = to_body;
    return observe(y - to_body * state.angular_velocity - bias_of_rate, H, covariance);
}

Verdict InertialFilter::observe_vector(const Vec3& y, const Vec3& in_world,
                                       const Mat3& covariance) {
    const Mat3 to_body = state.orientation.conjugate().toRotationMatrix();
    Matrix H = sees_nothing();
    H.block<3, 3>(0, rotation) = to_body * cross_matrix(in_world);
    return observe(y - to_body * in_world, H, covariance);
}

Verdict InertialFilter::observe(const Vec3& innovation, const Matrix& H, const Mat3& covariance) {
    const auto c = correct<double>(error_, innovation, H, covariance);
    const bool accepted =
        std::isfinite(c.squared_distance) && (gate <= 0 || c.squared_distance <= gate);
    if (accepted) {
        error_ = c.estimate;
        fold(error_.mean);
    }
    return {accepted, c.squared_distance, innovation};
}

// The covariance is not changed. Rotating it by half the correction, as is done for errors in body
// axes, would let gravity give information on yaw after a large correction of the tilt.
void InertialFilter::fold(const Vector& error) {
    const Vec3 turn = error.segment<3>(rotation);
    state.position += error.segment<3>(position);
    state.velocity += error.segment<3>(velocity);
    state.orientation = (exponential_map(turn) * state.orientation).normalized();
    state.angular_velocity += error.segment<3>(angular_velocity);
    bias_of_force += error.segment<3>(force_bias);
    bias_of_rate += error.segment<3>(rate_bias);
    error_.mean.setZero();
}

} // namespace bris
