#pragma once

#include "components/material.hpp"

#include <array>
#include <vector>

namespace bris {

/// A sphere falls on a floor and bounces, with linear springs and the dashpot of a restitution
/// (MFiX DEM01, DEM02; Garg, Galvin, Li and Pannala 2012).
struct Bounce {
    double radius = 0.1, density = 2600; ///< m, kg/m3
    double height = 0.5;                 ///< m, of the centre at the start, > radius
    double stiffness = 5e4;              ///< N/m, of the contact
    double restitution = 0.9;            ///< of the contact without weight
    Tension tension = Tension::allowed;
    double gravity = 9.81; ///< m/s2
    unsigned bounces = 1;
    double steps_per_contact = 1000; ///< of pi sqrt(m/k)
};
struct BounceRecord {
    double begin = 0, end = 0;          ///< s, of the contact
    double speed_in = 0, speed_out = 0; ///< m/s
    double overlap = 0;                 ///< m, largest
    double apex = 0;                    ///< m, of the centre after the bounce
};
/// Flight between the steps is a parabola, on which the leapfrog is exact.
std::vector<BounceRecord> run_experiment(const Bounce& bounce);

/// Two spheres pressed between floor and lid, a linear system of two degrees of freedom while
/// nothing parts (MFiX DEM03).
struct Stack {
    double radius = 5e-4;                        ///< m
    std::array<double, 2> density{20000, 10000}; ///< kg/m3, lower, upper
    double lid = 1.8e-3;                         ///< m, height of the lid
    double stiffness = 1e3;                      ///< N/m, of every contact
    double restitution = 0.5;
    double gravity = 9.81;
    std::array<double, 2> begin{4.5e-4, 1.35e-3}; ///< m, heights of the centres at t = 0, at rest
    double step = 0.005;                          ///< dt over sqrt(m/k), m of the upper sphere
    double duration = 5e-3;                       ///< s
};
struct StackResult {
    std::array<double, 2> height{}, exact{}; ///< m, at the end
    double largest_error = 0;                ///< m, at any step
    double travel = 0;                       ///< m, largest distance of a sphere from its beginning
    std::uint64_t steps = 0;
};
/// `exact` is the matrix exponential of the system.
StackResult run_experiment(const Stack& stack);

/// Fall, or rise, of a sphere under local damping.
struct DampedFall {
    double fraction = 0.7, speed = -3, gravity = 9.81;
    unsigned steps = 200;
};
double run_experiment(const DampedFall& fall); ///< acceleration over gravity

} // namespace bris
