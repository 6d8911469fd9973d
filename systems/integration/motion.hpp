#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Force and torque begin the step at zero.
void clear_forces(Rows<Bodies, Force, Torque> bodies);

/// Adds weight: true mass times gravity.
void apply_gravity(Rows<Bodies, const Mass, Force> bodies, const Gravity& gravity);

/// Local damping of force and torque on free bodies, with velocities of the time of the positions
/// (inventory E13: for quasi-static runs). F_k <- F_k - alpha |F_k| sign(v_k), Cundall (1987).
void damp(Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
               Force, Torque>
              bodies,
          const LocalDamping& damping, const Clock& clock);

/// The same, booking the work that damping takes from each body (second order in dt).
void damp_and_accumulate_work(
    Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
         const AngularMomentum, const InertialMass, const InertialInertia, const Orientation, Force,
         Torque, DampingWork>
        bodies,
    const LocalDamping& damping, const Clock& clock);

/// Books the work of driven bodies on the grains: the force of this step times the mean of the
/// displacements before and after it (trapezoidal rule), and torque times spin.
void accumulate_boundary_work(
    Rows<Bodies, const MotionOf, const Force, const Torque, const Velocity, const DriveVelocity,
         const AngularVelocity, BoundaryWork>
        bodies,
    const Clock& clock);

/// Kick then drift (leapfrog): v(t + dt/2) = v(t - dt/2) + a dt, x(t + dt) = x + v dt. Second
/// order, symplectic for conservative forces. Driven bodies follow their DriveVelocity.
void integrate(Rows<Bodies, const MotionOf, const Force, const InertialMass, const DriveVelocity,
                    Velocity, Acceleration, Position>
                   bodies,
               const Clock& clock);

/// Rotation of single spheres: angular momentum by leapfrog; spin at the time of the new positions.
void rotate_spheres(Rows<Bodies, const MotionOf, const Torque, const SphereInertia, AngularMomentum,
                         AngularVelocity, StepAngularVelocity>
                        bodies,
                    const Clock& clock);

/// Rotation of clumps: angular momentum in the world frame by leapfrog (conserved exactly without
/// torque), then the free motion of the step at that angular momentum: fourth order in the angle
/// turned (Magnus expansion with Simpson weights), or the midpoint rule where the angle is below
/// 1e-4 rad and the difference below 1e-12 rad. Orientation stays a unit quaternion.
void rotate_clumps(Rows<Bodies, const MotionOf, const Torque, const InertialInertia,
                        AngularMomentum, AngularVelocity, StepAngularVelocity, Orientation>
                       bodies,
                   const Clock& clock);

// A scene of single spheres is told from one of clumps by its column SphereInertia.
using PositionedSpheres =
    Rows<Bodies, const Position, const Velocity, const StepAngularVelocity, const InertialMass,
         const MotionOf, const SphereInertia, RigidMotion>;
using PositionedBodies =
    Rows<Bodies, const SpheresOf, const Position, const Velocity, const StepAngularVelocity,
         const Orientation, const InertialMass, const MotionOf, RigidMotion, CentreOf>;
using PositionedBalls = Rows<Listed, const ListedBall, ListedPosition>;

/// What contacts read, at the new positions: motion of each body over the last step; places of
/// single spheres, which stand in the rows of their bodies.
void update_sphere_positions(PositionedSpheres bodies, PositionedBalls listed);

/// The same for clumps: places of their listed spheres, and their centres.
void update_clump_positions(PositionedBodies bodies, PositionedBalls listed);

/// What dashpots read besides: velocities of the time of the positions, predicted with the last
/// acceleration, less those of the last step. Without them damping is of first order in dt.
void update_kicks(
    Rows<Bodies, const Acceleration, const AngularVelocity, const StepAngularVelocity, Kick> bodies,
    const Clock& clock);

/// Bound on how far any point of a body has gone since the last prune.
void bound_displacement(
    Rows<Bodies, const Position, const PrunedAt, const SphereInertia, DisplacementBound> bodies);

/// The same with rotation: |dx| + 2 R |dq|, never less than the displacement of any point.
void bound_displacement_and_rotation(Rows<Bodies, const Position, const Orientation, const PrunedAt,
                                          const BoundingRadius, DisplacementBound>
                                         bodies);

/// Planes and facets follow their hosts; a host that turns (Spin) turns the velocity of its
/// surfaces only.
void update_planes(Rows<Planes, const LocalPlane, const HostRow, PlanePosition> planes,
                   Rows<Bodies, const Position, const Velocity, const AngularVelocity> bodies);
void update_facets(Rows<Facets, const LocalFacet, const HostRow, FacetPosition> facets,
                   Rows<Bodies, const Position, const Velocity, const AngularVelocity> bodies);

} // namespace bris
