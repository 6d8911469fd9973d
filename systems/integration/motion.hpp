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
void weigh(Rows<Bodies, const Mass, Force> bodies, const Gravity& gravity);

/// Local damping of force and torque on free bodies, with velocities of the time of the positions
/// (inventory E13: for quasi-static runs). F_k <- F_k - alpha |F_k| sign(v_k), Cundall (1987).
void damp(
    Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const Spin, Force, Torque>
        bodies,
    const LocalDamping& damping, const Clock& clock);

/// The same, booking the work that damping takes from each body (second order in dt).
void damp_and_book(Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const Spin,
                        const AngularMomentum, const InertialMass, const InertialInertia,
                        const Orientation, Force, Torque, DampingWork>
                       bodies,
                   const LocalDamping& damping, const Clock& clock);

/// Books the work of driven bodies on the grains: the force of this step times the mean of the
/// displacements before and after it (trapezoidal rule), and torque times spin.
void book_boundary_work(Rows<Bodies, const MotionOf, const Force, const Torque, const Velocity,
                             const DriveVelocity, const Spin, BoundaryWork>
                            bodies,
                        const Clock& clock);

/// Kick then drift (leapfrog): v(t + dt/2) = v(t - dt/2) + a dt, x(t + dt) = x + v dt. Second
/// order, symplectic for conservative forces. Driven bodies follow their DriveVelocity.
void integrate(Rows<Bodies, const MotionOf, const Force, const InertialMass, const DriveVelocity,
                    Velocity, Acceleration, Position>
                   bodies,
               const Clock& clock);

/// Rotation of single spheres: angular momentum by leapfrog; spin at the time of the new positions.
void turn_spheres(
    Rows<Bodies, const MotionOf, const Torque, const SphereInertia, AngularMomentum, Spin, StepSpin>
        bodies,
    const Clock& clock);

/// Rotation of clumps: angular momentum in the world frame by leapfrog (conserved exactly without
/// torque), then the free motion of the step at that angular momentum: fourth order in the angle
/// turned (Magnus expansion with Simpson weights), or the midpoint rule where the angle is below
/// 1e-4 rad and the difference below 1e-12 rad. Orientation stays a unit quaternion.
void turn(Rows<Bodies, const MotionOf, const Torque, const InertialInertia, AngularMomentum, Spin,
               StepSpin, Orientation>
              bodies,
          const Clock& clock);

// A scene of single spheres is told from one of clumps by its column SphereInertia.
using PlacedSpheres = Rows<Bodies, const Position, const Velocity, const StepSpin,
                           const InertialMass, const MotionOf, const SphereInertia, RigidMotion>;
using PlacedBodies =
    Rows<Bodies, const SpheresOf, const Position, const Velocity, const StepSpin, const Orientation,
         const InertialMass, const MotionOf, RigidMotion, CentreOf>;
using PlacedBalls = Rows<Listed, const ListedBall, Place>;

/// What contacts read, at the new positions: motion of each body over the last step; places of
/// single spheres, which stand in the rows of their bodies.
void place_spheres(PlacedSpheres bodies, PlacedBalls listed);

/// The same for clumps: places of their listed spheres, and their centres.
void place(PlacedBodies bodies, PlacedBalls listed);

/// What dashpots read besides: velocities of the time of the positions, predicted with the last
/// acceleration, less those of the last step. Without them damping is of first order in dt.
void place_kicks(Rows<Bodies, const Acceleration, const Spin, const StepSpin, Kick> bodies,
                 const Clock& clock);

/// Bound on how far any point of a body has gone since the last prune.
void measure_travel(
    Rows<Bodies, const Position, const PrunedAt, const SphereInertia, Travel> bodies);

/// The same with rotation: |dx| + 2 R |dq|, never less than the displacement of any point.
void measure_travel_and_turn(
    Rows<Bodies, const Position, const Orientation, const PrunedAt, const BoundingRadius, Travel>
        bodies);

/// Planes and facets follow their hosts; a host that turns (Spin) turns the velocity of its
/// surfaces only.
void place_planes(Rows<Planes, const LocalPlane, const HostRow, PlanePlace> planes,
                  Rows<Bodies, const Position, const Velocity, const Spin> bodies);
void place_facets(Rows<Facets, const LocalFacet, const HostRow, FacetPlace> facets,
                  Rows<Bodies, const Position, const Velocity, const Spin> bodies);

} // namespace bris
