#pragma once

#include "components/material.hpp"
#include "engine/simulation.hpp"

namespace bris {

/// Two equal spheres of which one, the guided sphere, has a prescribed motion: the response of a
/// contact to this motion. The other one, the heavy sphere, is too heavy to be moved by forces and
/// rotates as prescribed. Initially the guided sphere is above it along z.
class GuidedPair {
public:
    struct Settings {
        double radius = 0.01;    ///< m
        double heavy_radius = 0; ///< m, of the fixed sphere; 0: the same
        double overlap = 1e-5;   ///< m, initial
        Material material;
        OwnCoefficients own{}; ///< that only this law reads
        LawName law = LawName::linear;
        ContactPolicy policy;
        double dt = 1e-5; ///< s
    };
    /// Force (N), torque (N m) and normal force (N) on the heavy sphere.
    struct Answer {
        Vec3 force, torque;
        double normal_force;
    };

    explicit GuidedPair(const Settings& settings);
    /// Returns the response at the present positions, which the motion of the last step has
    /// reached. Then moves the guided sphere by `shift` (m) and rotates it by `turn` and the heavy
    /// sphere by `heavy_turn` (rotation vectors, rad).
    Answer step(const Vec3& shift, const Vec3& turn = Vec3::Zero(),
                const Vec3& heavy_turn = Vec3::Zero());
    Vec3 position() const; ///< m, of the guided sphere

private:
    Simulation simulation_;
    double dt_;
};

/// A slow oscillatory rotation of the guided sphere about its own centre, which shears the contact
/// at constant overlap.
struct ShearLoop {
    double stiffness = 1e6, shear_ratio = 0.5; ///< N/m, ks / kn
    double friction = 0.5, overlap = 1e-5;     ///< -, m
    double amplitude = 2e-5;                   ///< m, tangential displacement of the surfaces
    unsigned steps = 4000;                     ///< per cycle
};
struct ShearLoopResult {
    double work = 0;          ///< J, dissipated in the second cycle
    double exact = 0;         ///< J: 4 mu N (A - mu N / ks)
    double largest_ratio = 0; ///< largest ratio of tangential force to mu times normal force
};
/// Runs the experiment. Corners of the loop are cut, so the error is of first order in the step.
ShearLoopResult run_experiment(const ShearLoop& loop);

/// A loaded pair is sheared and then rotated by a full turn as one rigid body.
struct RigidTurn {
    Vec3 axis = Vec3::UnitX();
    double stretch = 1e-4; ///< m, of the tangential spring before the turn
    double radius = 0.01;  ///< m
    unsigned steps = 1000; ///< per turn
};
struct RigidTurnResult {
    double length_drift = 0; ///< largest | |F_t| / |initial F_t| - 1 |
    double angle = 0;        ///< rad, between the tangential force before and after the turn
};
RigidTurnResult run_experiment(const RigidTurn& turn);

/// The guided sphere rolls, twists or does both until the springs slip.
struct RollAndTwist {
    double rolling_friction = 0.1, twisting_friction = 0.1;
    bool roll = true, twist = true;
};
/// Torque relative to the normal force times the reduced radius R*.
double run_experiment(const RollAndTwist& motion);

} // namespace bris
