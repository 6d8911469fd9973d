#pragma once

#include "components/material.hpp"
#include "engine/options.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/verification/crystal.hpp"
#include "scenarios/verification/impact.hpp"

#include <string>
#include <vector>

namespace bris {

// Names by which a user chooses among policies, in the order of the enumerations. The names of laws
// come from the table of laws.

inline const std::vector<std::string> tension_names{"allowed", "cut", "calibrated"};
inline const std::vector<std::string> shear_history_names{"rescaled", "incremental", "total"};
inline const std::vector<std::string> target_names{"sphere", "plane", "facet", "edge", "vertex"};
inline const std::vector<std::string> lattice_names{"sc", "bcc", "fcc"};

/// Names of the laws whose coefficients materials alone state: choices of an option where pairs of
/// materials have none of their own.
std::vector<std::string> law_choices();
/// The law of that name. Throws InputError.
LawName law_named(const std::string& word);

/// The text of --explain: the systems that run, and those that do not, in a step of two spheres on
/// a plane under a law.
std::string explain_step(LawName law, Grains grains);

/// The density of a material and its elastic constants for both families of laws, as options.
struct MaterialOptions {
    Material material;
    explicit MaterialOptions(Material initial) : material(std::move(initial)) {}

    void describe(auto& option, const std::string& prefix, const std::string& of) {
        constexpr double rigid = 1e30; // N/m or Pa: no softer than a rigid wall
        option(prefix + "density", material.density, "kg/m3", "Density " + of + ".", above(0, 1e6));
        option(prefix + "young_modulus", material.young_modulus, "Pa",
               "Young's modulus " + of + " for Hertz laws.", above(0, rigid));
        option(prefix + "poisson_ratio", material.poisson_ratio, "",
               "Poisson's ratio " + of + " for Hertz laws.", above(-1, 0.5));
        option(prefix + "normal_stiffness", material.normal_stiffness, "N/m",
               "Normal stiffness " + of + " for linear laws, in series with the partner's.",
               above(0, rigid));
        option(prefix + "shear_stiffness", material.shear_stiffness, "N/m",
               "Tangential stiffness " + of + " for linear laws, in series with the partner's.",
               within(0, rigid));
    }
};

} // namespace bris
