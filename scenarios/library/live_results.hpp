#pragma once

#include "scenarios/ensemble/compared_curves.hpp"
#include "scenarios/library/live_prediction.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// Draws the curves of a live test, the estimate of friction and what the library predicts.
/// `rows`: of each stage axial strain, q, volumetric strain, friction and its deviation. Throws
/// OutputError.
void draw_live(const std::filesystem::path& png, const ComparedTests& tests,
               const std::vector<std::vector<double>>& rows, const LivePrediction& prediction,
               double learned_strain);

} // namespace bris
