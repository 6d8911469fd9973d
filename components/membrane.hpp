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

// The elements of a membrane stand ring by ring: element e is in ring e / sectors, sector e %
// sectors. They move along their sector's outward direction only.

struct ElementId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct ElementRadius : State<double> {
    static constexpr auto name = "radius", unit = "m";
}; // of its middle, from the axis
struct ElementSpeed : State<double> {
    static constexpr auto name = "speed", unit = "m/s";
}; // outwards, of the last step

struct ElementPush : Derived<double> {
    static constexpr auto name = "push", unit = "N";
}; // of the grains, outwards
struct ElementHold : Derived<double> {
    static constexpr auto name = "hold", unit = "";
}; // touching contacts, by their shares
struct ElementArea : Derived<double> {
    static constexpr auto name = "area", unit = "m2";
}; // on which pressure acts: dV/dr
struct PrunedRadius : Derived<double> {
    static constexpr auto name = "pruned_radius", unit = "m";
};
struct RebuiltRadius : Derived<double> {
    static constexpr auto name = "rebuilt_radius", unit = "m";
};

/// Where a contact stands on the membrane: between the middles of two elements of its sector, the
/// upper one of which takes `share` of its radial force.
struct Foot {
    double share;
    Row lower, upper;
};
struct FootOf : Derived<Foot> {
    static constexpr auto name = "foot", unit = "";
};

/// Radii of the rings around each height, by ring below (from -2 to the number of rings) and
/// sector: what a contact reads of the membrane. Derived; the lists give it its size.
struct MembraneBands {
    static constexpr auto name = "membrane_bands";
    std::vector<std::array<double, 4>> radii;
};

/// What a servo-driven membrane is made of and aims at. Groups of elements (rings, or single ones)
/// share one speed.
struct Membrane {
    static constexpr auto name = "membrane";
    static constexpr bool is_state = true;

    bool active = true;       ///< false: elements go on at the speed that a procedure gives them
    bool per_element = false; ///< each element is its own group, else each ring
    unsigned rings = 8, sectors = 12;
    EntityId body = nobody;       ///< takes the axial part of the contact forces; does not move
    Row body_row = no_row;        ///< derived, where that body stands now
    double ring_height = 0;       ///< m
    double target_pressure = 0;   ///< Pa, on the area of the current surface
    PressureAim aim;              ///< on the way to that target
    double damping = 0.7;         ///< local, of the groups' motion, in [0, 1)
    double contact_stiffness = 0; ///< N/m, of one grain contact on an element
    double largest_step = 0;      ///< m, of an element in a step
    std::vector<Vec3> outward;    ///< unit, by sector; the axis is x = y = 0
    std::vector<double> pressure; ///< Pa, on each group in the last step
    std::vector<double>
        stiffness; ///< N/m, the largest that each group has touched: sets its inertia

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
