#pragma once

#include "engine/archive.hpp"
#include "engine/math.hpp"

#include <vector>

namespace bris {

/// What a servo-driven membrane is made of and aims at. Elements are bodies with Motion::servo that
/// move along their outward radial direction; groups of them share one velocity.
struct Membrane {
    static constexpr auto name = "membrane";
    static constexpr bool is_state = true;

    bool active = true;           ///< false: the membrane stands still (preparation)
    bool per_element = false;     ///< each element is its own group, else each ring
    unsigned rings = 8, sectors = 12;
    unsigned first_facet = 0;     ///< row in Facets of element 0; elements follow ring by ring
    double ring_height = 0;       ///< m
    double target_pressure = 0;   ///< Pa, on the current polygon's area
    double gain = 0.3;            ///< of the step that would cancel the error, in (0, 1)
    double contact_stiffness = 0; ///< N/m, of one grain contact on an element
    double largest_step = 0;      ///< m, of an element in a step
    std::vector<Vec3> outward;    ///< unit, by sector; the axis is x = y = 0
    std::vector<double> pressure; ///< Pa, on each group in the last step
    std::vector<double> radius;   ///< m, of each element: distance of its plane from the axis

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// The top platen: its plane, and how it is driven.
struct Platen {
    static constexpr auto name = "platen";
    static constexpr bool is_state = true;

    unsigned plane = 0;           ///< row in Planes
    bool controlled = false;      ///< true: pressure is the aim; false: `speed` is given
    double speed = 0;             ///< m/s, downwards
    double target_pressure = 0;   ///< Pa
    double gain = 0.3;            ///< as the membrane's
    double contact_stiffness = 0; ///< N/m, of one grain contact on it
    double largest_step = 0;      ///< m, in a step
    double pressure = 0;          ///< Pa, in the last step

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

} // namespace bris
