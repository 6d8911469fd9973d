#pragma once

#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "engine/archive.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <array>
#include <tuple>
#include <vector>

namespace bris {

// A sleeve is a surface of triangles between nodes that have a mass and move by themselves, around
// the z axis. The nodes are ordered by level: node n belongs to level n / columns. Those of the
// first level are clamped at the bottom, those of the last level at the top platen. Rows of nodes
// and triangles never change.

struct NodeId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct NodePosition : State<Vec3> {
    static constexpr auto name = "position", unit = "m";
};
/// Velocity in the last step.
struct NodeVelocity : State<Vec3> {
    static constexpr auto name = "velocity", unit = "m/s";
};
/// The largest stiffness so far of what holds the node; it sets the node's mass.
struct NodeStiffness : State<double> {
    static constexpr auto name = "stiffness", unit = "N/m";
};
/// Mass of the latex around the node.
struct NodeLatex : State<double> {
    static constexpr auto name = "latex", unit = "kg";
};
/// Force of the grains on the node.
struct NodePush : Derived<Vec3> {
    static constexpr auto name = "push", unit = "N";
};
/// Force of latex, pressure and grains on the node.
struct NodeForce : Derived<Vec3> {
    static constexpr auto name = "force", unit = "N";
};
/// Part of that force which the pressure exerts.
struct NodePressure : Derived<Vec3> {
    static constexpr auto name = "pressure", unit = "N";
};
/// Stiffness in this step.
struct NodeHold : Derived<double> {
    static constexpr auto name = "hold", unit = "N/m";
};
/// Position at the last prune of the pair lists.
struct PrunedNode : Derived<Vec3> {
    static constexpr auto name = "pruned", unit = "m";
};
/// Position at the last rebuild of the candidate pairs.
struct RebuiltNode : Derived<Vec3> {
    static constexpr auto name = "rebuilt", unit = "m";
};

struct TriangleId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
/// Nodes of a triangle, counter-clockwise as seen from the grains.
struct TriangleNodes {
    std::array<EntityId, 3> node;
};
struct Corners : State<TriangleNodes, EntityId> {
    static constexpr auto name = "corners", unit = "";
};
/// The triangle without stress: its corners are (0, 0), (along, 0) and (back, high), in m.
struct RestTriangle {
    double along, back, high;
};
struct RestShape : State<RestTriangle> {
    static constexpr auto name = "rest", unit = "m";
};
/// Corners of a triangle in space; the fourth number of each fills a row of lanes.
struct alignas(32) PlacedTriangle {
    std::array<std::array<double, 4>, 3> corners;
};
template <class PositionOf>
PlacedTriangle placed(const TriangleNodes& nodes, PositionOf&& position_of) {
    PlacedTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& x = position_of(nodes.node[k]);
        t.corners[k] = {x.x(), x.y(), x.z(), 0};
    }
    return t;
}
struct TriangleAt : Derived<PlacedTriangle> {
    static constexpr auto name = "at", unit = "m";
};

/// Shares of the corners in a contact on a triangle, and the force (N) on the triangle.
struct Tread {
    Vec3 share, force;
};
struct TreadOf : Derived<Tread> {
    static constexpr auto name = "tread", unit = "";
};

/// Sums of the contacts on the nodes, over all near rows and ranks: force in units of
/// ForceGrid::force, and number in units of ElementSums::hold_unit.
struct SleeveSums {
    static constexpr auto name = "sleeve_sums";
    std::vector<std::array<WideInteger, 4>> of;
};

/// Latex, size and state of a sleeve. What its servo aims at is in Membrane.
struct Sleeve {
    static constexpr auto name = "sleeve";
    static constexpr bool is_state = true;

    double thickness = 0.5e-3;    ///< m
    double young_modulus = 1.4e6; ///< Pa
    double density = 950;         ///< kg/m3
    bool wrinkles = true;         ///< the latex takes no compression
    double largest_stretch = 7;   ///< at which the run stops, since latex tears
    unsigned columns = 0;         ///< nodes of a level
    double radius = 0;            ///< m, of the circle inscribed in the mould
    /// J since the sleeve was put on: of the pressure and of the clamps on it; taken by damping.
    double pressure_work = 0, clamp_work = 0, damping_work = 0;

    // of the last step, derived
    double pressure = 0;   ///< Pa
    double volume = 0;     ///< m3 inside
    double energy = 0;     ///< J, elastic
    double unbalanced = 0; ///< mean force on a free node over the mean force of the pressure
    static auto fields(auto& self) {
        return std::tie(self.columns, self.thickness, self.young_modulus, self.density,
                        self.wrinkles, self.largest_stretch, self.radius, self.pressure_work,
                        self.clamp_work, self.damping_work);
    }
    void save(Archive& archive) const { put_fields(archive, "sleeve", fields(*this)); }
    void load(const Archive& archive) { get_fields(archive, "sleeve", fields(*this)); }
};

} // namespace bris
