#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <algorithm>

namespace bris {

/// Who moves a body.
enum class Motion : std::uint32_t {
    free,       ///< forces
    fixed,      ///< nobody
    prescribed, ///< its DriveVelocity, set by a procedure
    servo       ///< a system of systems/servo; its DriveVelocity is zero
};

struct BodyId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct MotionOf : State<std::uint32_t> {
    static constexpr auto name = "motion", unit = "";
};
struct MaterialOf : State<std::uint32_t> {
    static constexpr auto name = "material", unit = "";
};
struct ShapeOf : State<std::uint32_t> {
    static constexpr auto name = "shape", unit = "";
}; // template in the clump library

struct Position : State<Vec3> {
    static constexpr auto name = "position", unit = "m";
}; // centre of mass
struct Velocity : State<Vec3> {
    static constexpr auto name = "velocity", unit = "m/s";
}; // half a step back (leapfrog)
struct Acceleration : State<Vec3> {
    static constexpr auto name = "acceleration", unit = "m/s2";
}; // of the last step
struct AngularVelocity : State<Vec3> {
    static constexpr auto name = "angular_velocity", unit = "rad/s";
}; // at the same time as Position
struct StepAngularVelocity : State<Vec3> {
    static constexpr auto name = "step_angular_velocity", unit = "rad/s";
}; // rotation vector of the last step / dt
struct AngularMomentum : State<Vec3> {
    static constexpr auto name = "angular_momentum", unit = "kg m2/s";
}; // world frame, half a step back
struct Orientation : State<Quat> {
    static constexpr auto name = "orientation", unit = "x y z w";
}; // principal axes to world
struct DriveVelocity : State<Vec3> {
    static constexpr auto name = "drive_velocity", unit = "m/s";
}; // of driven bodies

struct Mass : State<double> {
    static constexpr auto name = "mass", unit = "kg";
}; // weight, volume
struct InertialMass : State<double> {
    static constexpr auto name = "inertial_mass", unit = "kg";
}; // motion; differs when scaled
struct SphereInertia : State<double> {
    static constexpr auto name = "sphere_inertia", unit = "kg m2";
}; // scenes of single spheres
struct Inertia : State<Vec3> {
    static constexpr auto name = "inertia", unit = "kg m2";
}; // principal, true
struct InertialInertia : State<Vec3> {
    static constexpr auto name = "inertial_inertia", unit = "kg m2";
}; // principal; differs when scaled
struct BoundingRadius : State<double> {
    static constexpr auto name = "bounding_radius", unit = "m";
}; // about Position, of all it carries

struct Growth : State<double> {
    static constexpr auto name = "growth", unit = "";
}; // of full size, while a specimen is made

// the energy ledger of a body, since the start; columns that are only there if somebody asks
struct FrictionWork : State<double> {
    static constexpr auto name = "friction_work", unit = "J";
}; // taken in the pairs it owns
struct ViscousWork : State<double> {
    static constexpr auto name = "viscous_work", unit = "J";
}; // likewise, by dashpots
struct RollingWork : State<double> {
    static constexpr auto name = "rolling_work", unit = "J";
}; // likewise, by rolling and twisting
struct DampingWork : State<double> {
    static constexpr auto name = "damping_work", unit = "J";
}; // taken by local damping
struct ScalingWork : State<double> {
    static constexpr auto name = "scaling_work", unit = "J";
}; // put in when masses are scaled in motion
struct BoundaryWork : State<double> {
    static constexpr auto name = "boundary_work", unit = "J";
}; // a driven body's, on the grains

struct Force : Derived<Vec3> {
    static constexpr auto name = "force", unit = "N";
}; // resultant of this step
struct Torque : Derived<Vec3> {
    static constexpr auto name = "torque", unit = "N m";
}; // about Position
struct DisplacementBound : Derived<double> {
    static constexpr auto name = "displacement_bound", unit = "m";
}; // bound, since the last prune

/// What a touching contact reads of a body in one cache line: velocity of its centre over the last
/// step, inverse inertial mass (0 if driven), spin over the last step; and the centre itself, from
/// which the velocity of any of its points follows.
struct alignas(64) MotionRow {
    double vx, vy, vz, inverse_mass, omega_x, omega_y, omega_z, unused;
};
struct alignas(32) CentreRow {
    double x, y, z, unused;
};
/// What dashpots need besides: from the velocities of the last step's middle to those of its end.
struct alignas(64) KickRow {
    double vx, vy, vz, unused, omega_x, omega_y, omega_z, unused_too;
};
struct Kick : Derived<KickRow> {
    static constexpr auto name = "kick", unit = "m/s, rad/s";
}; // only for laws with dashpots
struct RigidMotion : Derived<MotionRow> {
    static constexpr auto name = "rigid_motion", unit = "m/s, 1/kg, rad/s";
};
struct CentreOf : Derived<CentreRow> {
    static constexpr auto name = "centre", unit = "m";
}; // kept only for clumps

/// Where a body's spheres stand: all of them, and the listed ones.
struct SphereRun {
    Row first = 0, count = 0, first_listed = 0, listed = 0;
};
struct SpheresOf : Derived<SphereRun> {
    static constexpr auto name = "spheres_of", unit = "";
};

/// A pose to measure travel from.
struct Pose {
    Vec3 position;
    Quat orientation;
};
/// Bound on the travel of any point of a body between two poses.
inline double displacement_bound(const Vec3& x, const Quat& q, const Pose& from, double radius) {
    // |q - q0| (q and -q are the same rotation) is 2 sin(angle/4), and a point at R moves
    // 2 R sin(angle/2) <= 2 R |q - q0|
    const auto difference = (q.coeffs() - from.orientation.coeffs()).squaredNorm();
    const auto opposite = (q.coeffs() + from.orientation.coeffs()).squaredNorm();
    return (x - from.position).norm() + 2 * radius * std::sqrt(std::min(difference, opposite));
}

struct PrunedAt : Derived<Pose> {
    static constexpr auto name = "pruned_at", unit = "";
};
struct RebuiltAt : Derived<Pose> {
    static constexpr auto name = "rebuilt_at", unit = "";
};

} // namespace bris
