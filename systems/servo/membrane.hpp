#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"
#include "engine/world.hpp"

namespace bris {

/// Adds the sums of all chunks. Where a chunk has more than the grid holds, the sums may have
/// wrapped: the elements get no force in the step, in which the guard stops the run.
void sum_membrane(const ElementSums& rows, const Overload& overload, MembraneSums& sums);

/// Forces of the grains on the elements. The contact kernels divide the radial part of a contact
/// between the two nearest elements by the lever rule, so that push times speed is the power of the
/// contacts.
void push_membrane(Rows<Elements, ElementPush, ElementHold> elements, const MembraneSums& sums,
                   const ForceGrid& grid);

/// Accumulates the work of the elements on the grains over half a step. It runs twice a step, at
/// the speed of the last step and at the speed of the next (trapezoidal rule).
void accumulate_membrane_work(Rows<Bodies, BoundaryWork> bodies,
                              Rows<Elements, const ElementPush, const ElementSpeed> elements,
                              const Membrane& membrane, const Clock& clock);

/// Moves the groups of a membrane (rings or elements) by their force balance (ServoMotion): the
/// force of the grains against the set point of the pressure (PressureAim) on the area dV/dr of the
/// current surface below the platen, and notes the mean area inside the rings. A group that the
/// platen has passed follows the ring below it. An element that its neighbours hide has no area for
/// the pressure to act on, and an element that reaches the axis has met no grains: either is
/// recorded in Health and stops the run.
void servo_membrane(
    Rows<Elements, ElementRadius, ElementSpeed, ElementArea, const ElementPush, const ElementHold>
        elements,
    Rows<Planes, const PlanePosition> planes, Membrane& membrane, Platen& platen,
    const Clock& clock, Health& health);

/// Response of a boundary to a force: that of a body with local damping and with the mass that the
/// time step requires for the stiffness (N/m) of its contacts. A wall whose speed is proportional
/// to the pressure error responds a hundred times more slowly to the soft modes of a specimen.
struct ServoMotion {
    /// N/m, the largest so far: a wall must not become lighter when it loses contacts.
    double& stiffness;
    double damping, largest_step, dt;
    double least_mass = 0; ///< kg; 0: the mass that the time step requires
    /// Speed (m/s) after one step, for a resultant force (N) and the present contact stiffness
    /// (N/m).
    double next(double speed, double force, double touching);
};

/// Area (m2) of each element below the height `top` (m) on which the pressure acts: the derivative
/// of the volume with respect to the element's radius. `radius` and `area`: one number per element.
void compute_areas(const Membrane& membrane, const double* radius, double top, double* area);

/// Volume (m3) inside a membrane between z = 0 and z = `top` (m).
double membrane_volume(const Membrane& membrane, const double* radius, double top);

/// Area (m2) of the polygon of a ring.
double ring_area(const Membrane& membrane, const double* radius, std::size_t ring);

} // namespace bris
