#pragma once

#include "components/law.hpp"
#include "components/material.hpp"
#include "engine/options.hpp"

namespace bris {

/// What the edges of the rocks do at contacts, for the laws that read it; all zero: nothing.
struct RockEdges {
    double contact_strength = 0;       ///< Pa
    double cone_half_angle = 0;        ///< rad
    double edge_radius = 0;            ///< m
    double friction_rise = 0;          ///< -
    double friction_half_pressure = 0; ///< Pa
    double friction_half_force = 0;    ///< N
    double couple_arm = 0;             ///< m
    double couple_force = 0;           ///< N

    void declare_options(auto& option) {
        option("contact_strength", contact_strength, "Pa",
               "Pressure of a contact at which an edge yields and becomes blunt; 0: it does not.",
               within(0, 1e12));
        option("cone_half_angle", cone_half_angle, "rad", "Half-angle of the cone that an edge is.",
               within(0, 1.57));
        option("edge_radius", edge_radius, "m",
               "Radius of the tip of an edge before it yields; 0: that of the spheres of a rock.",
               within(0, 10));
        option("friction_rise", friction_rise, "",
               "Friction between rocks at low load above --friction.", within(0, 100));
        option("friction_half_pressure", friction_half_pressure, "Pa",
               "Mean pressure of a Hertz contact at which half of --friction-rise is left; 0: it "
               "stays.",
               within(0, 1e12));
        option("friction_half_force", friction_half_force, "N",
               "Normal force of a linear contact at which half of --friction-rise is left; 0: it "
               "stays.",
               within(0, 1e9));
        option("couple_arm", couple_arm, "m",
               "Arm of the couple with which edges and faces resist rolling and twisting: its "
               "limit is the arm times the normal force.",
               within(0, 1));
        option("couple_force", couple_force, "N",
               "Normal force at which that limit is halved, as asperities break; it approaches "
               "this force times the arm. 0: it stays in proportion.",
               within(0, 1e9));
    }
    bool are_given() const;
    void give_to(Material& rock) const;
};

/// Throws InputError if edges are given to a law that does not read them.
void require_edges_are_read(const RockEdges& edges, LawName law);

} // namespace bris
