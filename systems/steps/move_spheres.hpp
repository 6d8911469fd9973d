#pragma once

#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/pair.hpp"
#include "components/slab.hpp"
#include "systems/integration/motion.hpp"

#include <string>
#include <vector>

namespace bris {

using MovedSpheres =
    Rows<Bodies, const BodyId, const SumsFromOthers, const SpheresOf, const Mass, const MotionOf,
         const InertialMass, const SphereInertia, const DriveVelocity, const PrunedAt,
         const InnerSkin, const BoundingRadius, Force, Torque, Velocity, Acceleration, Position,
         AngularMomentum, AngularVelocity, StepAngularVelocity, RigidMotion, Kick,
         DisplacementBound>;

/// Systems that move_spheres combines.
inline const std::vector<std::string> parts_of_move_spheres{"sum_contacts",
                                                            "apply_gravity",
                                                            "integrate",
                                                            "rotate_spheres",
                                                            "update_sphere_positions",
                                                            "update_kicks",
                                                            "bound_displacement",
                                                            "watch_motion"};

/// From the sums of contact forces to what contacts read in the next step, in scenes of single
/// spheres on which nothing but contacts and gravity acts. It gives the same bits as the systems
/// that it combines, but each number of a body is loaded once. Forces and torques on spheres are
/// stored in observed steps only, the columns of motion in steps in which they are due.
void move_spheres(MovedSpheres bodies, Rows<ForceSums, const NextSum, ContactSum> sums,
                  Rows<Listed, ListedPosition> listed, const ForceGrid& grid, const Census& census,
                  const BoundarySums& boundaries, const Gravity& gravity, const Limits& limits,
                  const Clock& clock, const Observation& observation, MotionColumns& columns,
                  ListState& lists, Alarm& alarm);

/// Writes the columns of motion that move_spheres has not written (MotionColumns), and the bounds
/// on displacements.
void complete_motion(MovedSpheres bodies, Rows<Listed, ListedPosition> listed,
                     MotionColumns& columns, ListState& lists);
/// The same at the end of a step in which something went wrong, for the message and the checkpoint.
void complete_motion_in_trouble(MovedSpheres bodies, Rows<Listed, ListedPosition> listed,
                                const Alarm& alarm, const Health& health, MotionColumns& columns,
                                ListState& lists);

/// The same on several ranks, at the end of a step after which candidates are reviewed, bodies are
/// exchanged, or a fault of another rank stops the run.
void complete_motion_for_ranks(MovedSpheres bodies, Rows<Listed, ListedPosition> listed,
                               const Slab& slab, const Health& health, MotionColumns& columns,
                               ListState& lists);

/// Systems that move_spheres_of_slab combines: the same on several ranks.
inline const std::vector<std::string> parts_of_move_spheres_of_slab{
    "sum_contacts",   "apply_gravity",      "integrate",
    "rotate_spheres", "pass_spheres",       "update_sphere_positions",
    "update_kicks",   "bound_displacement", "watch_motion"};

/// Moves the bodies of this rank as move_spheres does, gives ghosts their motion, and updates what
/// contacts read of them.
void move_spheres_of_slab(MovedSpheres bodies, Rows<ForceSums, const NextSum, ContactSum> sums,
                          Rows<Listed, ListedPosition> listed, const ForceGrid& grid,
                          const Census& census, const BoundarySums& boundaries,
                          const Gravity& gravity, const Limits& limits, const Clock& clock,
                          const Observation& observation, MotionColumns& columns, Slab& slab,
                          ListState& lists, Alarm& alarm);

} // namespace bris
