#pragma once

#include "components/material.hpp"

#include <array>
#include <vector>

namespace bris {

/// A sphere falls on a floor and bounces, with a linear spring and a dashpot that follows from the
/// coefficient of restitution (MFiX DEM01, DEM02; Garg, Galvin, Li and Pannala 2012).
struct Bounce {
    double radius = 0.1, density = 2600; ///< m, kg/m3
    double height = 0.5;                 ///< m, initial height of the centre, > radius
    double stiffness = 5e4;              ///< N/m, of the contact
    double restitution = 0.9;            ///< of the contact without gravity
    Tension tension = Tension::allowed;
    double gravity = 9.81; ///< m/s2
    unsigned bounces = 1;
    double steps_per_contact = 1000; ///< number of time steps in pi sqrt(m/k)
};
struct BounceRecord {
    double begin = 0, end = 0;          ///< s, of the contact
    double speed_in = 0, speed_out = 0; ///< m/s
    double overlap = 0;                 ///< m, largest
    double apex = 0;                    ///< m, largest height of the centre after the bounce
};
/// Runs the experiment and returns one record for each bounce. Instants between steps follow from
/// the parabola of free flight, on which the leapfrog is exact. Throws InputError for a height that
/// is not above the radius or a gravity that is not above 0, SimulationError if the sphere comes to
/// rest before the last bounce.
std::vector<BounceRecord> run_experiment(const Bounce& bounce);

/// Two spheres compressed between a floor and a lid: a linear system of two degrees of freedom as
/// long as all contacts stay closed (MFiX DEM03).
struct Stack {
    double radius = 5e-4;                        ///< m
    std::array<double, 2> density{20000, 10000}; ///< kg/m3, lower, upper
    double lid = 1.8e-3;                         ///< m, height of the lid
    double stiffness = 1e3;                      ///< N/m, of every contact
    double restitution = 0.5;
    double gravity = 9.81;
    std::array<double, 2> begin{4.5e-4, 1.35e-3}; ///< m, heights of the centres at rest at t = 0
    double step = 0.005;                          ///< dt / sqrt(m/k) with m of the upper sphere
    double duration = 5e-3;                       ///< s
};
struct StackResult {
    std::array<double, 2> height{}, exact{}; ///< m, heights of the centres at the end
    double largest_error = 0;                ///< m, largest error of a height at any step
    double travel = 0; ///< m, largest distance of a sphere from its initial position
    std::uint64_t steps = 0;
};
/// Runs the experiment. The exact heights follow from the matrix exponential of the system. Throws
/// SimulationError if a contact opens.
StackResult run_experiment(const Stack& stack);

/// A sphere that falls or rises under local damping.
struct DampedFall {
    double fraction = 0.7, speed = -3, gravity = 9.81;
    unsigned steps = 200;
};
/// Downward acceleration of the sphere, relative to gravity.
double run_experiment(const DampedFall& fall);

} // namespace bris
