#pragma once

#include "scenarios/collision/impact.hpp"
#include "tests/verification/check.hpp"

#include <span>

namespace bris {

/// A group of checks: one experiment with an exact solution, or a family of such experiments.
struct VerificationCase {
    const char* name;
    const char* source; ///< source of the exact values
    void (*run)(Checks&);
};

std::span<const VerificationCase> verification_cases();

/// Runs a group of checks. Throws InputError for an unknown name.
std::vector<Check> verify(const std::string& name);

/// Compares an impact of a sphere on a rigid wall under `hertz_mindlin_viscous` with its law
/// integrated in fine steps. Throws as run_experiment.
std::vector<Check> verify_impact(const std::string& name, const Impact& impact, double tolerance);

namespace detail {
void verify_elastic_impacts(Checks&);
void verify_impact_scaling(Checks&);
void verify_restitution(Checks&);
void verify_phases(Checks&);
void verify_oblique_impacts(Checks&);
void verify_slip_impacts(Checks&);
void verify_spinning_impacts(Checks&);
void verify_energy_defect(Checks&);
void verify_surfaces(Checks&);
void verify_bouncing(Checks&);
void verify_stack(Checks&);
void verify_rolling(Checks&);
void verify_array(Checks&);
void verify_local_damping(Checks&);
void verify_top(Checks&);
void verify_pendulum(Checks&);
void verify_mass_properties(Checks&);
void verify_chains(Checks&);
void verify_crystals(Checks&);
void verify_waves(Checks&);
void verify_stability(Checks&);
void verify_contact_pair(Checks&);
void verify_liquid_bridge(Checks&);
void verify_descriptions(Checks&);
void verify_gas(Checks&);
void verify_cooling(Checks&);
void verify_rest(Checks&);
} // namespace detail

} // namespace bris
