#pragma once

#include "components/material.hpp"
#include "engine/options.hpp"

#include <filesystem>
#include <string>

namespace bris {

/// Properties of a rock that a file of assets/materials gives.
struct RockMaterial {
    double density = 2700;           ///< kg/m3
    double normal_stiffness = 6.3e7; ///< N/m, of one partner
    double shear_stiffness = 6.3e7;  ///< N/m, of one partner
    double friction = 0.6;
    double restitution = 0.5;
    double wet_friction_loss = 0; ///< share of the friction that wet stones lose, without fines

    void declare_options(auto& option) {
        option("density", density, "kg/m3", "Density of the solid.", above(0, 1e5));
        option("normal_stiffness", normal_stiffness, "N/m",
               "Normal stiffness of one partner of a contact.", above(0, 1e12));
        option("shear_stiffness", shear_stiffness, "N/m",
               "Tangential stiffness of one partner of a contact.", within(0, 1e12));
        option("friction", friction, "", "Coefficient of friction, rock on rock.", within(0, 10));
        option("restitution", restitution, "", "Coefficient of restitution, rock on rock.",
               above(0, 1));
        option("wet_friction_loss", wet_friction_loss, "",
               "Share of the friction that wet stones lose, without fines.", within(0, 0.9));
    }
    Material material(const std::string& name) const;
};

/// Reads a file of `name = value` lines. `name`: a file of assets/materials without its ending, or
/// a path. Throws InputError with file:line, what was expected and what was found.
RockMaterial read_rock_material(const std::string& name);

} // namespace bris
