#include "engine/lanes.hpp"
#include "systems/integration/motion.hpp"

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

// Angular momentum in the body's axes of a free body: dL/dt = L x w, w = L / I.
Vec3 rate(const Vec3& momentum, const Vec3& inverse_inertia) {
    return momentum.cross(momentum.cwiseProduct(inverse_inertia));
}

Vec3 advance(const Vec3& momentum, const Vec3& inverse, double dt) { // classical Runge-Kutta
    const Vec3 a = rate(momentum, inverse), b = rate(momentum + 0.5 * dt * a, inverse),
               c = rate(momentum + 0.5 * dt * b, inverse), d = rate(momentum + dt * c, inverse);
    return momentum + dt / 6 * (a + 2 * b + 2 * c + d);
}

/// Rotation vector, in the body's axes, of the free motion over dt.
Vec3 rotation_of_step(const Vec3& momentum, const Vec3& inverse, double dt) {
    const Vec3 spin = momentum.cwiseProduct(inverse);
    if (spin.squaredNorm() * dt * dt < 1e-8)
        return dt * (momentum + 0.5 * dt * rate(momentum, inverse)).cwiseProduct(inverse);
    const Vec3 half = advance(momentum, inverse, 0.5 * dt), full = advance(half, inverse, 0.5 * dt);
    const Vec3 middle = half.cwiseProduct(inverse), last = full.cwiseProduct(inverse);
    return dt / 6 * (spin + 4 * middle + last) + dt * dt / 12 * spin.cross(last);
}

// one step of Newton towards norm 1: rounding leaves it within 1e-15
void renormalise(Quat& q) { q.coeffs() *= 0.5 * (3 - q.squaredNorm()); }

} // namespace

void turn_spheres(Rows<Bodies, const MotionOf, const Torque, const SphereInertia, AngularMomentum, Spin, StepSpin> bodies,
                  const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* torque = bodies.column<Torque>();
    const double* inertia = bodies.column<SphereInertia>();
    Vec3* momentum = bodies.column<AngularMomentum>();
    Vec3* spin = bodies.column<Spin>();
    Vec3* step_spin = bodies.column<StepSpin>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (motion[b] != free_motion) continue;
        momentum[b] += clock.dt * torque[b];
        spin[b] = (momentum[b] + 0.5 * clock.dt * torque[b]) / inertia[b];
        step_spin[b] = momentum[b] / inertia[b];
    }
}

void turn(Rows<Bodies, const MotionOf, const Torque, const InertialInertia, AngularMomentum, Spin,
               StepSpin, Orientation, Axes> bodies,
          const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* torque = bodies.column<Torque>();
    const Vec3* inertia = bodies.column<InertialInertia>();
    Vec3* momentum = bodies.column<AngularMomentum>();
    Vec3* spin = bodies.column<Spin>();
    Vec3* step_spin = bodies.column<StepSpin>();
    Quat* orientation = bodies.column<Orientation>();
    Mat3* axes = bodies.column<Axes>();
    const double dt = clock.dt, per_second = 1 / dt;
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (motion[b] != free_motion) continue;
        momentum[b] += dt * torque[b];
        const Vec3 local = axes[b].transpose() * momentum[b];
        const Vec3 inverse = inertia[b].cwiseInverse();
        const Vec3 rotation = rotation_of_step(local, inverse, dt);
        step_spin[b] = axes[b] * (rotation * per_second); // a rotation's axis is the same in both frames
        Quat q = orientation[b] * exponential_map(rotation);
        renormalise(q);
        orientation[b] = q;
        axes[b] = q.toRotationMatrix();
        const Vec3 now = axes[b].transpose() * (momentum[b] + 0.5 * dt * torque[b]);
        spin[b] = axes[b] * now.cwiseProduct(inverse);
    }
}

namespace {

// velocities of the last step (of the half step before the positions) or of the positions' own time
void place_at(PlacedBodies bodies, Rows<Listed, const ListedBall, Place> listed, double since_velocity, const Vec3* spin) {
    const auto* run = bodies.column<SpheresOf>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* acceleration = bodies.column<Acceleration>();
    const Mat3* axes = bodies.column<Axes>();
    const double* mass = bodies.column<InertialMass>();
    const auto* motion = bodies.column<MotionOf>();
    const Ball* ball = listed.column<ListedBall>();
    PlaceRow* place = listed.column<Place>();
    const auto quad = [](const Vec3& v, double last) { return Quad{v.x(), v.y(), v.z(), last}; };
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (run[b].listed == 0) continue;
        const Mat3& a = axes[b];
        const Quad ex{a(0, 0), a(1, 0), a(2, 0), 0}, ey{a(0, 1), a(1, 1), a(2, 1), 0},
            ez{a(0, 2), a(1, 2), a(2, 2), 0};
        const Quad x = quad(position[b], 0), w = quad(spin[b], 0);
        const Quad v = quad(velocity[b] + since_velocity * acceleration[b],
                            motion[b] == free_motion ? 1 / mass[b] : 0);
        for (Row k = run[b].first_listed; k < run[b].first_listed + run[b].listed; ++k) {
            const Ball& o = ball[k];
            const Quad arm = o.centre.x() * ex + o.centre.y() * ey + o.centre.z() * ez;
            store(&place[k].x, x + arm + Quad{0, 0, 0, o.radius});
            store(&place[k].vx, v + cross(w, arm));
        }
    }
}

void place_turns_at(Rows<Bodies, const SpheresOf, const Spin, const StepSpin> bodies,
                    Rows<Listed, const ListedBall, Turn> listed, const Vec3* spin) {
    const auto* run = bodies.column<SpheresOf>();
    const Ball* ball = listed.column<ListedBall>();
    TurnRow* turn = listed.column<Turn>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        for (Row k = run[b].first_listed; k < run[b].first_listed + run[b].listed; ++k)
            turn[k] = {spin[b].x(), spin[b].y(), spin[b].z(), ball[k].radius};
}

} // namespace

template <>
void place<VelocityTime::last_step>(PlacedBodies bodies, Rows<Listed, const ListedBall, Place> listed, const Clock&) {
    place_at(bodies, listed, 0, bodies.column<StepSpin>());
}
template <>
void place<VelocityTime::now>(PlacedBodies bodies, Rows<Listed, const ListedBall, Place> listed, const Clock& clock) {
    place_at(bodies, listed, 0.5 * clock.dt, bodies.column<Spin>());
}
template <>
void place_turns<VelocityTime::last_step>(Rows<Bodies, const SpheresOf, const Spin, const StepSpin> bodies,
                                          Rows<Listed, const ListedBall, Turn> listed) {
    place_turns_at(bodies, listed, bodies.column<StepSpin>());
}
template <>
void place_turns<VelocityTime::now>(Rows<Bodies, const SpheresOf, const Spin, const StepSpin> bodies,
                                    Rows<Listed, const ListedBall, Turn> listed) {
    place_turns_at(bodies, listed, bodies.column<Spin>());
}

void measure_travel_and_turn(Rows<Bodies, const Position, const Orientation, const PrunedAt,
                                  const BoundingRadius, Travel> bodies) {
    const Vec3* position = bodies.column<Position>();
    const Quat* orientation = bodies.column<Orientation>();
    const Pose* from = bodies.column<PrunedAt>();
    const double* radius = bodies.column<BoundingRadius>();
    double* travel = bodies.column<Travel>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        travel[b] = travel_bound(position[b], orientation[b], from[b], radius[b]);
}

} // namespace bris
