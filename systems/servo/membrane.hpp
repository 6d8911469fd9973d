#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"
#include "engine/world.hpp"

namespace bris {

/// Gives each element its share of the contact forces: the two elements between which a contact
/// stands take its radial part as a lever would, so that push times speed is the power of the
/// contacts.
void push_membrane(Rows<Elements, ElementPush, ElementHold> elements,
                   Rows<NearMembrane, const NearPair, const PairForce, const FootOf> near,
                   const NearIndex<MembranePairs>& index, const Membrane& membrane);

/// Books half a step's work of the elements on the grains: once at the speed of the last step, once
/// at that of the next (trapezoidal rule).
void accumulate_membrane_work(Rows<Bodies, BoundaryWork> bodies,
                              Rows<Elements, const ElementPush, const ElementSpeed> elements,
                              const Membrane& membrane, const Clock& clock);

/// Moves the groups of a membrane (rings or elements) by their balance of forces (ServoMotion): the
/// grains' push against the target pressure (PressureAim) on the area dV/dr of the current surface
/// below the platen (inventory E3). A group that the platen has passed follows the ring below it.
/// An element that its neighbours hide has no area to press on, and one that reaches the axis has
/// found no grains: that is noted in Health and stops the run.
void servo_membrane(
    Rows<Elements, ElementRadius, ElementSpeed, ElementArea, const ElementPush, const ElementHold>
        elements,
    Rows<Planes, const PlanePosition> planes, Membrane& membrane, const Platen& platen,
    const Clock& clock, Health& health);

/// How a boundary answers a force: as a body with local damping that is as heavy as the step needs
/// for the stiffness (N/m) that it touches. A wall that only follows its error answers the soft
/// modes of a specimen a hundred times slower.
struct ServoMotion {
    double&
        stiffness; ///< N/m, the largest so far: a wall must not get lighter where it loses contacts
    double damping, largest_step, dt;
    /// Speed (m/s) one step on, for a resultant force (N) and the stiffness that touches now.
    double next(double speed, double force, double touching);
};

/// Area (m2) on which each element presses below the height `top`: the derivative of the volume
/// with respect to its radius. Both by element.
void compute_areas(const Membrane& membrane, const double* radius, double top, double* area);

/// Volume (m3) inside a membrane between z = 0 and `top`.
double membrane_volume(const Membrane& membrane, const double* radius, double top);

/// Area (m2) of the polygon of a ring.
double ring_area(const Membrane& membrane, const double* radius, std::size_t ring);

} // namespace bris
