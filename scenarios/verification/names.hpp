#pragma once

#include "components/material.hpp"
#include "engine/options.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/verification/crystal.hpp"
#include "scenarios/verification/impact.hpp"
#include "systems/fusion/sensor_filter.hpp"

#include <string>
#include <vector>

namespace bris {

// The words by which a user chooses among the laws and policies; the order is that of the
// enumerations.

inline const std::vector<std::string> law_names{
    "linear_frictionless", "linear",        "linear_viscous",        "linear_rolling",
    "hertz_frictionless",  "hertz_mindlin", "hertz_mindlin_viscous", "hertz_mindlin_rolling"};
inline const std::vector<std::string> tension_names{"allowed", "cut", "calibrated"};
inline const std::vector<std::string> shear_history_names{"rescaled", "incremental", "total"};
inline const std::vector<std::string> target_names{"sphere", "plane", "facet", "edge", "vertex"};
inline const std::vector<std::string> lattice_names{"sc", "bcc", "fcc"};

/// The value whose word it is. Throws InputError.
template <class Enumeration>
Enumeration named(const std::vector<std::string>& names, const std::string& word);
extern template LawName named(const std::vector<std::string>&, const std::string&);
extern template Tension named(const std::vector<std::string>&, const std::string&);
extern template ShearHistory named(const std::vector<std::string>&, const std::string&);
extern template Target named(const std::vector<std::string>&, const std::string&);
extern template Lattice named(const std::vector<std::string>&, const std::string&);
extern template FilterKind named(const std::vector<std::string>&, const std::string&);

/// What runs, and what does not, in a step of two spheres on a plane under a law: for --explain.
std::string explain_step(LawName law, Grains grains);

/// A material as options: the elastic constants of both families of laws, with friction and
/// restitution.
struct MaterialOptions {
    Material material;
    explicit MaterialOptions(Material initial) : material(std::move(initial)) {}

    void describe(auto& option, const std::string& prefix, const std::string& of) {
        option(prefix + "density", material.density, "kg/m3", of, above(0));
        option(prefix + "young_modulus", material.young_modulus, "Pa", of + "; Hertz", above(0));
        option(prefix + "poisson_ratio", material.poisson_ratio, "", of + "; Hertz",
               Range{.low = -1, .high = 0.5, .low_accepted = false});
        option(prefix + "normal_stiffness", material.normal_stiffness, "N/m",
               of + "; linear laws, in series with the partner's", above(0));
        option(prefix + "shear_stiffness", material.shear_stiffness, "N/m", of + "; likewise",
               at_least(0));
    }
};

} // namespace bris
