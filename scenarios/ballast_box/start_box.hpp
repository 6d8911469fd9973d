#pragma once

#include "engine/run.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ballast_box/box_settings.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// The world of a box with its step. Throws InputError, and SimulationError where its rocks need
/// more memory than there is.
Simulation make_box_simulation(const BallastBox& box, const Common& common);

/// The systems of its step, those of the fields of a fouled run included (--explain).
std::string explain_box(const BallastBox& box, const Common& common);

/// Settings of the state that a finished bed of a box is brought to: the run of table 1, fines and
/// water. They refer to `common`.
std::vector<std::string_view> settings_of_state(const Common& common);

/// Continues a run from --resume; does nothing without it. Settings in `may_differ` may have
/// changed. Fields are added where the checkpoint has them. Throws InputError, OutputError.
void resume_box(Run& run, Simulation& simulation, const BallastBox& box, const Common& common,
                const std::vector<std::string_view>& may_differ);

} // namespace bris
