#pragma once

#include "components/material.hpp"
#include "engine/math.hpp"
#include "engine/world.hpp"

namespace bris::testing {

/// Gives all grains of a small bed edges that yield under their weight, whose friction falls with
/// the load and which resist rolling and twisting.
inline void add_edges(World& world) {
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) {
        m.young_modulus = 2e8;
        m.poisson_ratio = 0.25;
        m.rolling_friction = 0.8;
        m.twisting_friction = 0.5;
        m.contact_strength = 1e7;
        m.cone_half_angle = pi / 3;
        m.edge_radius = 0.006;
        m.friction_rise = 0.5;
        m.friction_half_pressure = 3e5;
        m.friction_half_force = 0.05;
        m.couple_arm = 5e-4;
        m.couple_force = 0.5;
    }
    materials.mix();
}

} // namespace bris::testing
