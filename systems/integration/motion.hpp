#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Adds weight: true mass times gravity.
void apply_gravity(Rows<Bodies, const Mass, Force> bodies, const Gravity& gravity);

/// Local damping of force and torque on free bodies, with the velocities at the time of the
/// positions. For quasi-static runs only. F_k <- F_k - alpha |F_k| sign(v_k), Cundall (1987).
void damp(Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
               Force, Torque>
              bodies,
          const LocalDamping& damping, const Clock& clock);

/// The same, and accumulates the work that damping takes from each body (second order in dt).
void damp_and_accumulate_work(
    Rows<Bodies, const MotionOf, const Velocity, const Acceleration, const AngularVelocity,
         const AngularMomentum, const InertialMass, const InertialInertia, const Orientation, Force,
         Torque, DampingWork>
        bodies,
    const LocalDamping& damping, const Clock& clock);

/// Accumulates the work of driven bodies on the grains: the force of this step times the mean of
/// the displacements before and after it (trapezoidal rule), and torque times angular velocity.
void accumulate_boundary_work(
    Rows<Bodies, const MotionOf, const Force, const Torque, const Velocity, const DriveVelocity,
         const AngularVelocity, BoundaryWork>
        bodies,
    const Clock& clock);

/// Leapfrog (kick, then drift): v(t + dt/2) = v(t - dt/2) + a dt, x(t + dt) = x + v dt. Second
/// order, symplectic for conservative forces. Driven bodies follow their DriveVelocity.
void integrate(Rows<Bodies, const MotionOf, const Force, const InertialMass, const DriveVelocity,
                    Velocity, Acceleration, Position>
                   bodies,
               const Clock& clock);

/// Rotation of single spheres: angular momentum by leapfrog; angular velocity at the time of the
/// new positions.
void rotate_spheres(Rows<Bodies, const MotionOf, const Torque, const SphereInertia, AngularMomentum,
                         AngularVelocity, StepAngularVelocity>
                        bodies,
                    const Clock& clock);

/// Rotation of clumps: angular momentum in the global frame by leapfrog (conserved exactly without
/// torque), then torque-free rotation over the step with that angular momentum. The rotation is of
/// fourth order in its angle (Magnus expansion with Simpson weights); where the angle is below 1e-4
/// rad the midpoint rule is used, which differs by less than 1e-12 rad. The orientation stays a
/// unit quaternion.
void rotate_clumps(Rows<Bodies, const MotionOf, const Torque, const InertialInertia,
                        AngularMomentum, AngularVelocity, StepAngularVelocity, Orientation>
                       bodies,
                   const Clock& clock);

// The column SphereInertia distinguishes a scene of single spheres from a scene of clumps.
using PositionedSpheres =
    Rows<Bodies, const Position, const Velocity, const StepAngularVelocity, const InertialMass,
         const MotionOf, const SphereInertia, RigidMotion>;
using PositionedBodies =
    Rows<Bodies, const SpheresOf, const Position, const Velocity, const StepAngularVelocity,
         const Orientation, const InertialMass, const MotionOf, RigidMotion, CentreOf>;
using PositionedBalls = Rows<Listed, const ListedBall, ListedPosition>;

/// Updates what contacts read to the new positions: the motion of each body over the last step, and
/// the positions of single spheres, which have the rows of their bodies.
void update_sphere_positions(PositionedSpheres bodies, Rows<Listed, ListedPosition> listed);

/// The same for clumps: the positions of their listed spheres, and their centres.
void update_clump_positions(PositionedBodies bodies, PositionedBalls listed);

/// Updates what only dashpots read: what predicts the velocities at the time of the positions from
/// those of the last step. Without this prediction damping would be of first order in dt.
void update_kicks(
    Rows<Bodies, const Acceleration, const AngularVelocity, const StepAngularVelocity, Kick>
        bodies);

/// Upper bound on the displacement of any point of a body since the last prune, in scenes of single
/// spheres. New lists become due where it exceeds the inner skin.
void bound_displacement(Rows<Bodies, const Position, const PrunedAt, const SphereInertia,
                             const InnerSkin, DisplacementBound>
                            bodies,
                        ListState& lists);

/// The same in scenes of clumps, with rotation: |dx| + 2 R |dq|, never less than the displacement
/// of any point.
void bound_displacement_and_rotation(
    Rows<Bodies, const Position, const Orientation, const PrunedAt, const PrunedOrientation,
         const BoundingRadius, const InnerSkin, DisplacementBound>
        bodies,
    ListState& lists);

/// Moves planes and facets with their hosts. A driven host that rotates changes only the velocity
/// of its surfaces.
void update_planes(Rows<Planes, const LocalPlane, const HostRow, PlanePosition> planes,
                   Rows<Bodies, const Position, const Velocity, const AngularVelocity> bodies);

/// Facets in scenes of single spheres, whose hosts have no orientation.
void update_facets(
    Rows<Facets, const LocalFacet, const HostRow, FacetPosition> facets,
    Rows<Bodies, const Position, const Velocity, const AngularVelocity, const SphereInertia>
        bodies);

/// Facets in scenes of clumps: they turn with their hosts. Free hosts are given the velocities over
/// the last step, as grains are.
void update_turned_facets(Rows<Facets, const LocalFacet, const HostRow, FacetPosition> facets,
                          Rows<Bodies, const MotionOf, const Position, const Velocity,
                               const AngularVelocity, const StepAngularVelocity, const Orientation>
                              bodies);

} // namespace bris
