#pragma once

#include "components/pressure_aim.hpp"
#include "engine/archive.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <array>
#include <tuple>
#include <vector>

namespace bris {

// The elements of a membrane are ordered by ring: element e belongs to ring e / sectors and to
// sector e % sectors. Elements move only along the outward direction of their sector.

struct ElementId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
/// Distance of the element's middle from the axis.
struct ElementRadius : State<double> {
    static constexpr auto name = "radius", unit = "m";
};
/// Outward speed in the last step.
struct ElementSpeed : State<double> {
    static constexpr auto name = "speed", unit = "m/s";
};

/// Outward force of the grains on the element.
struct ElementPush : Derived<double> {
    static constexpr auto name = "push", unit = "N";
};
/// Number of touching contacts, each weighted by the element's share of it.
struct ElementHold : Derived<double> {
    static constexpr auto name = "hold", unit = "";
};
/// Area on which the pressure acts: dV/dr.
struct ElementArea : Derived<double> {
    static constexpr auto name = "area", unit = "m2";
};
/// Radius at the last prune of the pair lists.
struct PrunedRadius : Derived<double> {
    static constexpr auto name = "pruned_radius", unit = "m";
};
/// Radius at the last rebuild of the candidate pairs.
struct RebuiltRadius : Derived<double> {
    static constexpr auto name = "rebuilt_radius", unit = "m";
};

/// Position of a contact on the membrane: between the middles of two elements of its sector. The
/// upper element takes the fraction `share` of the radial force, the lower one the remainder.
struct Foot {
    double share;
    Row lower, upper;
};
struct FootOf : Derived<Foot> {
    static constexpr auto name = "foot", unit = "";
};

/// Sums over the contacts on an element, as integers, so that their order does not matter.
struct ElementRow {
    std::int64_t push = 0; ///< in units of ForceGrid::force
    std::int64_t hold = 0; ///< in units of ElementSums::hold_unit
};
/// Sums by chunk of near rows and element.
struct ElementSums {
    static constexpr auto name = "element_sums";
    static constexpr double hold_unit = 0x1p-40;
    std::size_t elements = 0;
    std::vector<ElementRow> rows; ///< chunk * elements + element
};

/// What contacts read of the membrane, laid out for four consecutive rings at a time. Derived;
/// resized when the pair lists are built.
struct MembraneBands {
    static constexpr auto name = "membrane_bands";
    static constexpr int lowest = -3, rings_beyond = 6; ///< rings below the first, and in addition
    /// m, radii of the rings of each sector from ring `lowest` to the number of rings + 2; rings
    /// beyond either end repeat the end ring.
    std::vector<double> radii;
    std::vector<std::array<double, 4>> outward; ///< outward direction of each sector
};

/// Geometry, settings and target of a servo-controlled membrane. The elements of a group (a ring,
/// or a single element) share one speed.
struct Membrane {
    static constexpr auto name = "membrane";
    static constexpr bool is_state = true;

    bool active = true;       ///< false: elements keep the speed that a procedure gives them
    bool per_element = false; ///< true: each element is a group; false: each ring is a group
    unsigned rings = 8, sectors = 12;
    EntityId body = nobody;       ///< takes the axial part of the contact forces; does not move
    Row body_row = no_row;        ///< derived: current row of that body
    double ring_height = 0;       ///< m
    double target_pressure = 0;   ///< Pa, on the area of the current surface
    PressureAim aim;              ///< present set point on the ramp to that target
    double damping = 0.7;         ///< local damping of the groups' motion, in [0, 1)
    double contact_stiffness = 0; ///< N/m, of one grain contact on an element
    double largest_step = 0;      ///< m, largest displacement of an element in a step
    std::vector<Vec3> outward;    ///< unit vector of each sector; the axis is x = y = 0
    std::vector<double> pressure; ///< Pa, on each group in the last step
    /// N/m, by group: the largest sum of contact stiffnesses on it so far. It sets the group's
    /// inertia.
    std::vector<double> stiffness;

    static auto fields(auto& self) {
        return std::tie(self.active, self.target_pressure, self.damping, self.largest_step,
                        self.contact_stiffness, self.ring_height, self.aim.from, self.aim.to,
                        self.aim.left);
    }
    void save(Archive& archive) const {
        put_fields(archive, "membrane/settings", fields(*this));
        archive.put("membrane/pressure", std::span<const double>(pressure));
        archive.put("membrane/stiffness", std::span<const double>(stiffness));
    }
    void load(const Archive& archive) {
        get_fields(archive, "membrane/settings", fields(*this));
        pressure = archive.get<double>("membrane/pressure");
        stiffness = archive.get<double>("membrane/stiffness");
    }
};

} // namespace bris
