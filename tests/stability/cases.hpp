#pragma once

#include "tests/stability/suite.hpp"

namespace bris {

/// One function per file, named after what it tests. Where the engine must refuse a scene, the row
/// passes if it does.

StressRows stress_determinism(const StressSettings& s);         // S1
StressRows stress_step_limit(const StressSettings& s);          // S4
StressRows stress_vacuous_equilibrium(const StressSettings& s); // S5
StressRows stress_energy_budget(const StressSettings& s);       // S6
StressRows stress_servo(const StressSettings& s);               // S7
StressRows stress_size_ratio(const StressSettings& s);          // S8
StressRows stress_deep_overlap(const StressSettings& s);        // S9
StressRows stress_fast_impact(const StressSettings& s);         // S10
StressRows stress_sensors(const StressSettings& s);             // S11
StressRows stress_long_drift(const StressSettings& s);          // S12
StressRows stress_restitution(const StressSettings& s);         // S13
StressRows stress_unit_scaling(const StressSettings& s);        // S14
StressRows stress_frames(const StressSettings& s);              // S15
StressRows stress_momentum(const StressSettings& s);            // S16
StressRows stress_sleeping(const StressSettings& s);            // S18
StressRows stress_absurd_parameters(const StressSettings& s);   // S20
StressRows stress_not_a_number(const StressSettings& s);        // S22
StressRows stress_lists(const StressSettings& s);               // S25
StressRows stress_clump_dynamics(const StressSettings& s);      // S27
StressRows stress_soak(const StressSettings& s);                // S29

} // namespace bris
