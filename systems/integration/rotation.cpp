#include "engine/lane_math.hpp"
#include "engine/quad_math.hpp"
#include "systems/integration/motion.hpp"

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

// Rate of the angular momentum in the body's axes without torque: dL/dt = L x w, w = L / I.
Vec3Lanes rate(const Vec3Lanes& momentum, const Vec3Lanes& inverse_inertia) {
    return cross(momentum, scaled(momentum, inverse_inertia));
}

Vec3Lanes advance(const Vec3Lanes& momentum, const Vec3Lanes& inverse_inertia,
                  double dt) { // classical Runge-Kutta
    const Vec3Lanes a = rate(momentum, inverse_inertia),
                    b = rate(momentum + 0.5 * dt * a, inverse_inertia),
                    c = rate(momentum + 0.5 * dt * b, inverse_inertia),
                    d = rate(momentum + dt * c, inverse_inertia);
    return momentum + dt / 6 * (a + 2 * b + 2 * c + d);
}

/// Rotation vector of the torque-free motion over dt, in the body's axes.
Vec3Lanes rotation_of_step(const Vec3Lanes& momentum, const Vec3Lanes& inverse_inertia, double dt) {
    const Vec3Lanes omega = scaled(momentum, inverse_inertia);
    const Vec3Lanes midpoint =
        dt * scaled(momentum + 0.5 * dt * rate(momentum, inverse_inertia), inverse_inertia);
    const LaneMask large = dot(omega, omega) * (dt * dt) >= 1e-8;
    if (bits(large) == 0) return midpoint;
    const Vec3Lanes half = advance(momentum, inverse_inertia, 0.5 * dt),
                    full = advance(half, inverse_inertia, 0.5 * dt);
    const Vec3Lanes middle = scaled(half, inverse_inertia), last = scaled(full, inverse_inertia);
    const Vec3Lanes magnus =
        dt / 6 * (omega + 4 * middle + last) + dt * dt / 12 * cross(omega, last);
    return select(large, magnus, midpoint);
}

// one Newton step towards norm 1, after which the norm is within 1e-15 of 1
QuatLanes renormalised(const QuatLanes& q) {
    const Lane scale = 0.5 * (3.0 - squared_norm(q));
    return {scale * q.x, scale * q.y, scale * q.z, scale * q.w};
}

} // namespace

void rotate_spheres(Rows<Bodies, const MotionOf, const Torque, const SphereInertia, AngularMomentum,
                         AngularVelocity, StepAngularVelocity>
                        bodies,
                    const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* torque = bodies.column<Torque>();
    const double* inertia = bodies.column<SphereInertia>();
    Vec3* momentum = bodies.column<AngularMomentum>();
    Vec3* omega = bodies.column<AngularVelocity>();
    Vec3* step_omega = bodies.column<StepAngularVelocity>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (motion[b] != free_motion) continue;
        const double inverse_inertia = 1.0 / inertia[b];
        const Quad t = quad(torque[b]), after = quad(momentum[b]) + clock.dt * t;
        store(momentum[b], after);
        store(omega[b], inverse_inertia * (after + 0.5 * clock.dt * t));
        store(step_omega[b], inverse_inertia * after);
    }
}

void rotate_clumps(Rows<Bodies, const MotionOf, const Torque, const InertialInertia,
                        AngularMomentum, AngularVelocity, StepAngularVelocity, Orientation>
                       bodies,
                   const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* torque = bodies.column<Torque>();
    const Vec3* inertia = bodies.column<InertialInertia>();
    Vec3* momentum = bodies.column<AngularMomentum>();
    Vec3* omega = bodies.column<AngularVelocity>();
    Vec3* step_omega = bodies.column<StepAngularVelocity>();
    Quat* orientation = bodies.column<Orientation>();
    const double dt = clock.dt, per_second = 1 / dt;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const LaneMask free = equal(motion, rows, free_motion);
        if (bits(free) == 0) return;
        // driven bodies may have no inertia, and do not rotate
        const Vec3Lanes inverse_inertia = select(free, inverse(load(inertia, rows)), Vec3Lanes{});
        const Vec3Lanes before = load(momentum, rows), t = load(torque, rows),
                        after = before + dt * t;
        const QuatLanes from = load(orientation, rows);
        const AxesLanes axes = axes_of(from);
        const Vec3Lanes rotation = rotation_of_step(to_body(axes, after), inverse_inertia, dt);
        const QuatLanes to = renormalised(from * exponential_map(rotation));
        const AxesLanes turned = axes_of(to);
        const Vec3Lanes now = scaled(to_body(turned, after + 0.5 * dt * t), inverse_inertia);
        store(momentum, rows, select(free, after, before));
        // the axis of a rotation is the same in both frames
        store(step_omega, rows,
              select(free, to_world(axes, per_second * rotation), load(step_omega, rows)));
        store(omega, rows, select(free, to_world(turned, now), load(omega, rows)));
        store(orientation, rows, select(free, to, from));
    });
}

namespace {

/// The position of a sphere is centre + x along_x + y along_y + z along_z, where (x, y, z) is its
/// position in the body's axes. The fourth component is 0, to which the radius is added.
struct PositionedFrame {
    Quad centre, along_x, along_y, along_z;
};
using PositionedFrames = std::array<PositionedFrame, lane_count>;

void put(PositionedFrames& frames, Quad PositionedFrame::*row, const Vec3Lanes& v) {
    store_rows(transpose({v.x, v.y, v.z, Lane{}}), lane_count, [&](int q) {
        return reinterpret_cast<double*>(&(frames[static_cast<std::size_t>(q)].*row));
    });
}

void update_balls(const PositionedFrame& frame, const Ball* ball, Row count,
                  SphereRow* sphere_row) {
    constexpr Quad radius{0, 0, 0, 1};
    Row k = 0;
#ifdef __AVX512F__
    // two spheres at a time, with the same operations
    const Lane centre = in_each_row(frame.centre), along_x = in_each_row(frame.along_x),
               along_y = in_each_row(frame.along_y), along_z = in_each_row(frame.along_z);
    static_assert(sizeof(Ball) == 4 * sizeof(double));
    for (; k + 2 <= count; k += 2) {
        const Lane o = load_lane(ball[k].centre.data());
        const Lane x = __builtin_shufflevector(o, o, 0, 0, 0, 0, 4, 4, 4, 4),
                   y = __builtin_shufflevector(o, o, 1, 1, 1, 1, 5, 5, 5, 5),
                   z = __builtin_shufflevector(o, o, 2, 2, 2, 2, 6, 6, 6, 6),
                   r = __builtin_shufflevector(o, o, 3, 3, 3, 3, 7, 7, 7, 7);
        const Lane arm = x * along_x + y * along_y + z * along_z;
        store_lane(&sphere_row[k].x, centre + (arm + r * in_each_row(radius)));
    }
#endif
    for (; k < count; ++k) {
        const Ball& o = ball[k];
        const Quad arm = o.centre.x() * frame.along_x + o.centre.y() * frame.along_y +
                         o.centre.z() * frame.along_z;
        store(&sphere_row[k].x, frame.centre + (arm + o.radius * radius));
    }
}

} // namespace

void update_clump_positions(PositionedBodies bodies, PositionedBalls listed) {
    const auto* run = bodies.column<SpheresOf>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* omega = bodies.column<StepAngularVelocity>();
    const Quat* orientation = bodies.column<Orientation>();
    const double* mass = bodies.column<InertialMass>();
    const auto* motion = bodies.column<MotionOf>();
    MotionRow* row = bodies.column<RigidMotion>();
    CentreRow* centre = bodies.column<CentreOf>();
    const Ball* ball = listed.column<ListedBall>();
    SphereRow* sphere_row = listed.column<ListedPosition>();
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const LaneMask free = equal(motion, rows, free_motion);
        const Lane inverse_mass = free ? 1.0 / load(mass, rows) : Lane{};
        const Vec3Lanes x = load(position, rows), w = load(omega, rows), v = load(velocity, rows);
        const auto at = [&](int q) { return rows.first + static_cast<Row>(q); };
        store_rows(transpose({x.x, x.y, x.z, Lane{}}), rows.count,
                   [&](int q) { return &centre[at(q)].x; });
        store_rows(transpose({v.x, v.y, v.z, inverse_mass}), rows.count,
                   [&](int q) { return &row[at(q)].vx; });
        store_rows(transpose({w.x, w.y, w.z, Lane{}}), rows.count,
                   [&](int q) { return &row[at(q)].omega_x; });
        PositionedFrames frames;
        const AxesLanes axes = axes_of(load(orientation, rows));
        put(frames, &PositionedFrame::centre, x);
        put(frames, &PositionedFrame::along_x, axes.x);
        put(frames, &PositionedFrame::along_y, axes.y);
        put(frames, &PositionedFrame::along_z, axes.z);
        for (std::size_t k = 0; k < static_cast<std::size_t>(rows.count); ++k) {
            const SphereRun& r = run[rows.first + k];
            update_balls(frames[k], ball + r.first_listed, r.listed, sphere_row + r.first_listed);
        }
    });
}

void bound_displacement_and_rotation(
    Rows<Bodies, const Position, const Orientation, const PrunedAt, const PrunedOrientation,
         const BoundingRadius, const InnerSkin, DisplacementBound>
        bodies,
    ListState& lists) {
    const Vec3* position = bodies.column<Position>();
    const Quat* orientation = bodies.column<Orientation>();
    const Vec3* from = bodies.column<PrunedAt>();
    const Quat* orientation_then = bodies.column<PrunedOrientation>();
    const double* radius = bodies.column<BoundingRadius>();
    const double* skin = bodies.column<InnerSkin>();
    double* displacement = bodies.column<DisplacementBound>();
    unsigned exceeded = 0;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        // as displacement_bound
        const Vec3Lanes gone = load(position, rows) - load(from, rows);
        const QuatLanes q = load(orientation, rows), then = load(orientation_then, rows);
        const Lane turned = min(squared_norm(q - then), squared_norm(q + then));
        const Lane distance = sqrt(dot(gone, gone)) + 2.0 * load(radius, rows) * sqrt(turned);
        store(displacement, rows, distance);
        exceeded |= ~bits(distance <= load(skin, rows)) & ((1u << rows.count) - 1);
    });
    if (exceeded != 0) lists.note_used_up();
}

} // namespace bris
