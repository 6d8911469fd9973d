#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <algorithm>

namespace bris {

/// What moves a body.
enum class Motion : std::uint32_t {
    free,       ///< forces move it
    fixed,      ///< nothing moves it
    prescribed, ///< it moves at its DriveVelocity, which a procedure sets
    servo       ///< a system of systems/servo moves it; its DriveVelocity is zero
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
/// Index of the shape in the clump library.
struct ShapeOf : State<std::uint32_t> {
    static constexpr auto name = "shape", unit = "";
};

/// Centre of mass.
struct Position : State<Vec3> {
    static constexpr auto name = "position", unit = "m";
};
/// Velocity half a step back (leapfrog).
struct Velocity : State<Vec3> {
    static constexpr auto name = "velocity", unit = "m/s";
};
/// Acceleration in the last step.
struct Acceleration : State<Vec3> {
    static constexpr auto name = "acceleration", unit = "m/s2";
};
/// Angular velocity at the time of Position.
struct AngularVelocity : State<Vec3> {
    static constexpr auto name = "angular_velocity", unit = "rad/s";
};
/// Rotation vector of the last step, divided by dt.
struct StepAngularVelocity : State<Vec3> {
    static constexpr auto name = "step_angular_velocity", unit = "rad/s";
};
/// Angular momentum in the global frame, half a step back.
struct AngularMomentum : State<Vec3> {
    static constexpr auto name = "angular_momentum", unit = "kg m2/s";
};
/// Rotation from the principal axes to the global axes.
struct Orientation : State<Quat> {
    static constexpr auto name = "orientation", unit = "x y z w";
};
/// Velocity of driven bodies.
struct DriveVelocity : State<Vec3> {
    static constexpr auto name = "drive_velocity", unit = "m/s";
};

/// True mass: determines weight and volume.
struct Mass : State<double> {
    static constexpr auto name = "mass", unit = "kg";
};
/// Mass in the equation of motion; differs from Mass when masses are scaled.
struct InertialMass : State<double> {
    static constexpr auto name = "inertial_mass", unit = "kg";
};
/// Moment of inertia, in scenes of single spheres.
struct SphereInertia : State<double> {
    static constexpr auto name = "sphere_inertia", unit = "kg m2";
};
/// True principal moments of inertia.
struct Inertia : State<Vec3> {
    static constexpr auto name = "inertia", unit = "kg m2";
};
/// Principal moments in the equation of motion; differ from Inertia when scaled.
struct InertialInertia : State<Vec3> {
    static constexpr auto name = "inertial_inertia", unit = "kg m2";
};
/// Radius about Position of a sphere that contains all spheres of the body.
struct BoundingRadius : State<double> {
    static constexpr auto name = "bounding_radius", unit = "m";
};

/// Current size as a fraction of full size, while a specimen is generated.
struct Growth : State<double> {
    static constexpr auto name = "growth", unit = "";
};

// Energy budget of a body since the start. These columns exist only if the scene asks for them.

/// Energy dissipated by friction in the pairs that the body owns.
struct FrictionWork : State<double> {
    static constexpr auto name = "friction_work", unit = "J";
};
/// Energy dissipated by dashpots in the pairs that the body owns.
struct ViscousWork : State<double> {
    static constexpr auto name = "viscous_work", unit = "J";
};
/// Energy dissipated by rolling and twisting in the pairs that the body owns.
struct RollingWork : State<double> {
    static constexpr auto name = "rolling_work", unit = "J";
};
/// Energy dissipated by edges that yield in the pairs that the body owns.
struct WearWork : State<double> {
    static constexpr auto name = "wear_work", unit = "J";
};
/// Energy dissipated by local damping.
struct DampingWork : State<double> {
    static constexpr auto name = "damping_work", unit = "J";
};
/// Energy added when masses are scaled while bodies move.
struct ScalingWork : State<double> {
    static constexpr auto name = "scaling_work", unit = "J";
};
/// Work of a driven body on the grains.
struct BoundaryWork : State<double> {
    static constexpr auto name = "boundary_work", unit = "J";
};

/// Resultant force in this step.
struct Force : Derived<Vec3> {
    static constexpr auto name = "force", unit = "N";
};
/// Resultant torque about Position in this step.
struct Torque : Derived<Vec3> {
    static constexpr auto name = "torque", unit = "N m";
};
/// Upper bound on the displacement of any point of the body since the last prune.
struct DisplacementBound : Derived<double> {
    static constexpr auto name = "displacement_bound", unit = "m";
};

/// What a touching contact reads of a body, in one cache line: velocity of the centre over the last
/// step, inverse inertial mass (0 if driven) and angular velocity over the last step. With the
/// centre itself (CentreRow) they give the velocity of any point of the body. `spin_z`: see
/// KickRow.
struct alignas(64) MotionRow {
    double vx, vy, vz, inverse_mass, omega_x, omega_y, omega_z, spin_z;
};
struct alignas(32) CentreRow {
    double x, y, z, unused;
};
/// What only dashpots need: the acceleration in the last step, which gives the velocity at its end,
/// and the increment of the angular velocity from its middle to its end. The spin is the angular
/// velocity itself; move_spheres keeps it where these rows have room.
struct alignas(64) KickRow {
    double ax, ay, az, spin_x, omega_x, omega_y, omega_z, spin_y;
};
/// Exists only with contact laws that have dashpots.
struct Kick : Derived<KickRow> {
    static constexpr auto name = "kick", unit = "m/s2, rad/s";
};
struct RigidMotion : Derived<MotionRow> {
    static constexpr auto name = "rigid_motion", unit = "m/s, 1/kg, rad/s";
};
/// Written for clumps only.
struct CentreOf : Derived<CentreRow> {
    static constexpr auto name = "centre", unit = "m";
    static constexpr bool is_scratch = true;
};

/// Rows of a body's spheres: all of them in the table Spheres, and the listed ones in Listed.
struct SphereRun {
    Row first = 0, count = 0, first_listed = 0, listed = 0;
};
struct SpheresOf : Derived<SphereRun> {
    static constexpr auto name = "spheres_of", unit = "";
};

/// Reference pose, from which the displacement of a body is computed.
struct Pose {
    Vec3 position;
    Quat orientation;
};
/// Upper bound (m) on the displacement of any point of a body between two poses. `radius`: m, of a
/// sphere about the position that contains the body.
inline double displacement_bound(const Vec3& x, const Quat& q, const Pose& from, double radius) {
    // |q - q0| (q and -q are the same rotation) is 2 sin(angle/4), and a point at R moves
    // 2 R sin(angle/2) <= 2 R |q - q0|
    const auto difference = (q.coeffs() - from.orientation.coeffs()).squaredNorm();
    const auto opposite = (q.coeffs() + from.orientation.coeffs()).squaredNorm();
    return (x - from.position).norm() + 2 * radius * std::sqrt(std::min(difference, opposite));
}

/// How far the surface of the body may move before the short lists of pairs are made anew. Two
/// bodies are listed while the gap between their surfaces is below the sum of their skins.
struct InnerSkin : Derived<double> {
    static constexpr auto name = "inner_skin", unit = "m";
};
/// The same for the candidate pairs.
struct OuterSkin : Derived<double> {
    static constexpr auto name = "outer_skin", unit = "m";
    static constexpr bool is_carried = true;
};
/// Distance that the surface has moved per step while the last lists served. A body that was faster
/// before is forgotten slowly.
struct SurfaceSpeed : Derived<double> {
    static constexpr auto name = "surface_speed", unit = "m";
    static constexpr bool is_carried = true;
};

/// Position and, for clumps only, orientation at the last prune of the pair lists.
struct PrunedAt : Derived<Vec3> {
    static constexpr auto name = "pruned_at", unit = "m";
};
struct PrunedOrientation : Derived<Quat> {
    static constexpr auto name = "pruned_orientation", unit = "x y z w";
};
/// The same at the last rebuild of the candidate pairs.
struct RebuiltAt : Derived<Vec3> {
    static constexpr auto name = "rebuilt_at", unit = "m";
};
struct RebuiltOrientation : Derived<Quat> {
    static constexpr auto name = "rebuilt_orientation", unit = "x y z w";
};

} // namespace bris
