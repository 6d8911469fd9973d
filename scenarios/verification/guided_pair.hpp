#pragma once

#include "components/material.hpp"
#include "engine/simulation.hpp"

namespace bris {

/// Two equal spheres of which one is led by hand: what a contact answers to a given motion. The
/// other stays (it is too heavy to be moved) and spins as told. At first the led one stands above
/// it, along z.
class GuidedPair {
public:
    struct Settings {
        double radius = 0.01;  ///< m
        double overlap = 1e-5; ///< m, at the beginning
        Material material;
        LawName law = LawName::linear;
        ContactPolicy policy;
        double dt = 1e-5; ///< s
    };
    /// What the heavy sphere feels.
    struct Answer {
        Vec3 force, torque;
        double normal_force;
    };

    explicit GuidedPair(const Settings& settings);
    /// Answers at the places as they are, reached by the motion of the last step; then moves the
    /// led sphere by `shift` (m), turning it by `turn` and the heavy one by `heavy_turn` (rotation
    /// vectors, rad).
    Answer step(const Vec3& shift, const Vec3& turn = Vec3::Zero(),
                const Vec3& heavy_turn = Vec3::Zero());
    Vec3 position() const; ///< m, of the led sphere

private:
    Simulation simulation_;
    double dt_;
};

/// A slow oscillation of the led sphere along x, at constant overlap (its circle about the heavy
/// one is followed).
struct ShearLoop {
    double stiffness = 1e6, shear_ratio = 0.5; ///< N/m, ks / kn
    double friction = 0.5, overlap = 1e-5;     ///< overlap in m
    double amplitude = 2e-5;                   ///< m, of the surfaces
    unsigned steps = 4000;                     ///< a cycle
};
struct ShearLoopResult {
    double work = 0;          ///< J, taken in the second cycle
    double exact = 0;         ///< J: 4 mu N (A - mu N / ks)
    double largest_ratio = 0; ///< tangential over normal force, over mu
};
/// Corners of the loop are cut: first order in the step.
ShearLoopResult run_experiment(const ShearLoop& loop);

/// A loaded pair, sheared and then turned once as one rigid body.
struct RigidTurn {
    Vec3 axis = Vec3::UnitX();
    double stretch = 1e-4; ///< m, of the spring, before
    double radius = 0.01;  ///< m
    unsigned steps = 1000; ///< a turn
};
struct RigidTurnResult {
    double length_drift = 0; ///< largest | |F_t| / |F_t at first| - 1 |
    double angle = 0;        ///< rad, between the tangential force before and after
};
RigidTurnResult run_experiment(const RigidTurn& turn);

/// The led sphere rolls and twists at once until both springs slip.
struct RollAndTwist {
    double rolling_friction = 0.1, twisting_friction = 0.1;
    bool roll = true, twist = true;
};
/// Torque over the radius (of both, R*) times normal force.
double run_experiment(const RollAndTwist& motion);

} // namespace bris
