#include "engine/lane_math.hpp"
#include "engine/quad_math.hpp"
#include "systems/integration/motion.hpp"

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

Lane damped(const Lane& force, const Lane& velocity, double fraction) {
    const Lane drive = force * velocity, none = lanes(1);
    return force * (drive > 0.0 ? lanes(1 - fraction) : (drive < 0.0 ? lanes(1 + fraction) : none));
}

Vec3Lanes damped(const Vec3Lanes& force, const Vec3Lanes& velocity, double fraction) {
    return {damped(force.x, velocity.x, fraction), damped(force.y, velocity.y, fraction),
            damped(force.z, velocity.z, fraction)};
}

} // namespace

void apply_gravity(Rows<Bodies, const Mass, Force> bodies, const Gravity& gravity) {
    const double* mass = bodies.column<Mass>();
    Vec3* force = bodies.column<Force>();
    const Vec3Lanes g{lanes(gravity.value.x()), lanes(gravity.value.y()), lanes(gravity.value.z())};
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        store(force, rows, load(force, rows) + load(mass, rows) * g);
    });
}

void damp(Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
               Force, Torque>
              bodies,
          const LocalDamping& damping, const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* acceleration = bodies.column<Acceleration>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    Vec3* force = bodies.column<Force>();
    Vec3* torque = bodies.column<Torque>();
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const LaneMask free = equal(motion, rows, free_motion);
        const Vec3Lanes now = load(velocity, rows) + (0.5 * clock.dt) * load(acceleration, rows);
        const Vec3Lanes f = load(force, rows), t = load(torque, rows);
        store(force, rows, select(free, damped(f, now, damping.fraction), f));
        store(torque, rows, select(free, damped(t, load(omega, rows), damping.fraction), t));
    });
}

void damp_and_accumulate_work(
    Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
         const AngularMomentum, const InertialMass, const InertialInertia, const Orientation, Force,
         Torque, DampingWork>
        bodies,
    const LocalDamping& damping, const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* acceleration = bodies.column<Acceleration>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const double* mass = bodies.column<InertialMass>();
    Vec3* force = bodies.column<Force>();
    Vec3* torque = bodies.column<Torque>();
    const Vec3* momentum = bodies.column<AngularMomentum>();
    const Vec3* inertia = bodies.column<InertialInertia>();
    const Quat* orientation = bodies.column<Orientation>();
    double* work = bodies.column<DampingWork>();
    const double dt = clock.dt, half_step = 0.5 * dt;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const LaneMask free = equal(motion, rows, free_motion);
        if (bits(free) == 0) return;
        const Vec3Lanes v = load(velocity, rows), now = v + half_step * load(acceleration, rows);
        const Vec3Lanes f_before = load(force, rows), t_before = load(torque, rows);
        const Vec3Lanes f = damped(f_before, now, damping.fraction);
        const Vec3Lanes t = damped(t_before, load(omega, rows), damping.fraction);
        // with the means of the velocities before and after the kick this is the work that the
        // leapfrog itself does
        const Vec3Lanes mean_velocity = v + (half_step / load(mass, rows)) * f;
        const AxesLanes axes = axes_of(load(orientation, rows));
        const Vec3Lanes mean_momentum = to_body(axes, load(momentum, rows) + half_step * t);
        const Vec3Lanes mean_angular_velocity =
            to_world(axes, scaled(mean_momentum, inverse(load(inertia, rows))));
        const Lane taken =
            dt * (dot(f_before - f, mean_velocity) + dot(t_before - t, mean_angular_velocity));
        const Lane before = load(work, rows);
        store(work, rows, free ? before + taken : before);
        store(force, rows, select(free, f, f_before));
        store(torque, rows, select(free, t, t_before));
    });
}

void accumulate_boundary_work(
    Rows<Bodies, const MotionOf, const Force, const Torque, const Velocity, const DriveVelocity,
         const AngularVelocity, BoundaryWork>
        bodies,
    const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* force = bodies.column<Force>();
    const Vec3* before = bodies.column<Velocity>();
    const Vec3* after = bodies.column<DriveVelocity>();
    const Vec3* torque = bodies.column<Torque>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    double* work = bodies.column<BoundaryWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (motion[b] != free_motion)
            work[b] -=
                clock.dt * (0.5 * force[b].dot(before[b] + after[b]) + torque[b].dot(omega[b]));
}

void integrate(Rows<Bodies, const MotionOf, const Force, const InertialMass, const DriveVelocity,
                    Velocity, Acceleration, Position>
                   bodies,
               const Clock& clock) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* force = bodies.column<Force>();
    const double* mass = bodies.column<InertialMass>();
    const Vec3* drive = bodies.column<DriveVelocity>();
    Vec3* velocity = bodies.column<Velocity>();
    Vec3* acceleration = bodies.column<Acceleration>();
    Vec3* position = bodies.column<Position>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const bool free = motion[b] == free_motion;
        const Quad a = free ? quad(force[b]) / mass[b] : Quad{};
        const Quad v = free ? quad(velocity[b]) + clock.dt * a : quad(drive[b]);
        store(acceleration[b], a);
        store(velocity[b], v);
        store(position[b], quad(position[b]) + clock.dt * v);
    }
}

void update_sphere_positions(PositionedSpheres bodies, Rows<Listed, ListedPosition> listed) {
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* omega = bodies.column<StepAngularVelocity>();
    const double* mass = bodies.column<InertialMass>();
    const auto* motion = bodies.column<MotionOf>();
    MotionRow* row = bodies.column<RigidMotion>();
    SphereRow* target = listed.column<ListedPosition>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const double inverse_mass = motion[b] == free_motion ? 1.0 / mass[b] : 0;
        store(&row[b].vx, with_fourth(quad(velocity[b]), inverse_mass));
        store(&row[b].omega_x, quad(omega[b]));
        store(&target[b].x, with_fourth(quad(position[b]), target[b].radius));
    }
}

void update_kicks(
    Rows<Bodies, const Acceleration, const AngularVelocity, const StepAngularVelocity, Kick>
        bodies) {
    const Vec3* acceleration = bodies.column<Acceleration>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const Vec3* step_omega = bodies.column<StepAngularVelocity>();
    KickRow* kick = bodies.column<Kick>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        store(&kick[b].ax, quad(acceleration[b]));
        store(&kick[b].omega_x, quad(omega[b]) - quad(step_omega[b]));
    }
}

void bound_displacement(Rows<Bodies, const Position, const PrunedAt, const SphereInertia,
                             const InnerSkin, DisplacementBound>
                            bodies,
                        ListState& lists) {
    const Vec3* position = bodies.column<Position>();
    const Vec3* from = bodies.column<PrunedAt>();
    const double* skin = bodies.column<InnerSkin>();
    double* displacement = bodies.column<DisplacementBound>();
    unsigned exceeded = 0;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Vec3Lanes gone = load(position, rows) - load(from, rows);
        const Lane distance = sqrt(dot(gone, gone));
        store(displacement, rows, distance);
        exceeded |= ~bits(distance <= load(skin, rows)) & ((1u << rows.count) - 1);
    });
    if (exceeded != 0) lists.note_used_up();
}

void update_planes(Rows<Planes, const LocalPlane, const HostRow, PlanePosition> planes,
                   Rows<Bodies, const Position, const Velocity, const AngularVelocity> bodies) {
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const PlaneShape* shape = planes.column<LocalPlane>();
    const Row* host = planes.column<HostRow>();
    PlaneRow* target = planes.column<PlanePosition>();
    for (Row p = planes.first(); p < planes.last(); ++p)
        target[p] = {position[host[p]] + shape[p].point,
                     shape[p].normal,
                     {velocity[host[p]], omega[host[p]], position[host[p]]}};
}

void update_facets(
    Rows<Facets, const LocalFacet, const HostRow, FacetPosition> facets,
    Rows<Bodies, const Position, const Velocity, const AngularVelocity, const SphereInertia>
        bodies) {
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const FacetShape* shape = facets.column<LocalFacet>();
    const Row* host = facets.column<HostRow>();
    FacetRow* target = facets.column<FacetPosition>();
    for (Row f = facets.first(); f < facets.last(); ++f) {
        target[f] = placed(shape[f], position[host[f]], Quat(Quat::Identity()));
        target[f].motion = {velocity[host[f]], omega[host[f]], position[host[f]]};
    }
}

void update_turned_facets(Rows<Facets, const LocalFacet, const HostRow, FacetPosition> facets,
                          Rows<Bodies, const MotionOf, const Position, const Velocity,
                               const AngularVelocity, const StepAngularVelocity, const Orientation>
                              bodies) {
    const auto* motion = bodies.column<MotionOf>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const Vec3* step_omega = bodies.column<StepAngularVelocity>();
    const Quat* orientation = bodies.column<Orientation>();
    const FacetShape* shape = facets.column<LocalFacet>();
    const Row* host = facets.column<HostRow>();
    FacetRow* target = facets.column<FacetPosition>();
    for (Row f = facets.first(); f < facets.last(); ++f) {
        const Row h = host[f];
        const bool free = motion[h] == free_motion;
        target[f] = placed(shape[f], position[h], orientation[h]);
        target[f].motion = {velocity[h], free ? step_omega[h] : omega[h], position[h]};
        if (free) target[f].free_host = h;
    }
}

} // namespace bris
