#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "components/sleeve.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Adds the contacts on the nodes: each corner of a triangle takes its share of the force, so that
/// force and torque are those of the contact and force times velocity is its power. Where the grid
/// is overloaded the nodes get no force in the step, in which the guard stops the run.
void sum_sleeve(Rows<NearMembrane, const NearPair, const TreadOf> near,
                const NearIndex<MembranePairs>& index, Rows<Triangles, const Corners> triangles,
                Rows<Nodes, const NodeId> nodes, const ForceGrid& grid, const Overload& overload,
                SleeveSums& sums);

using NodeForces = Rows<Nodes, NodePush, NodeForce, NodePressure, NodeHold>;
using SleeveTriangles = Rows<Triangles, const Corners, const RestShape, const TriangleAt>;

/// Forces on the nodes: of the grains, of the latex (`stretch`), and of the pressure on every
/// triangle along its normal, a third on each corner. Notes the volume and the elastic energy, and
/// what the sleeve does to the platen. A triangle that is stretched more than latex bears is
/// recorded in Health and stops the run.
void pull_sleeve(NodeForces nodes, SleeveTriangles triangles,
                 Rows<Planes, const PlanePosition> planes, const SleeveSums& sums,
                 const ForceGrid& grid, Membrane& membrane, Sleeve& sleeve, Platen& platen,
                 Health& health);

/// Accumulates the work of the nodes on the grains over half a step. It runs twice a step, at the
/// velocities of the last step and of the next (trapezoidal rule).
void accumulate_sleeve_work(Rows<Bodies, BoundaryWork> bodies,
                            Rows<Nodes, const NodePush, const NodeVelocity> nodes,
                            const Membrane& membrane, const Clock& clock);

/// Moves the nodes, with local damping and with the mass of their latex, or more where the time
/// step requires it for what holds them. Clamped nodes follow the platens.
void move_sleeve(Rows<Nodes, const NodePush, const NodeForce, const NodePressure, const NodeHold,
                      const NodeLatex, NodePosition, NodeVelocity, NodeStiffness>
                     nodes,
                 const Membrane& membrane, const Platen& platen, const Clock& clock,
                 Sleeve& sleeve);

/// Places the triangles between the nodes.
void update_triangles(Rows<Triangles, const Corners, TriangleAt> triangles,
                      Rows<Nodes, const NodePosition> nodes);

/// J, of the motion of the nodes in the last step.
double kinetic_energy_of_sleeve(const World& world);

} // namespace bris
