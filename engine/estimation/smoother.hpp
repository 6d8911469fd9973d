#pragma once

#include "engine/estimation/kalman.hpp"

#include <span>
#include <vector>

namespace bris {

/// One step of a Kalman filter: the transition that led to it, and the estimates before and after
/// its measurements.
struct FilterStep {
    Transition transition;
    Gaussian predicted, corrected;
};

/// Estimates of all steps given all measurements, later ones included (Rauch, Tung and Striebel
/// 1965). The covariance is computed in Joseph's form: (I - C F) P (I - C F)^T + C (P_next + Q)
/// C^T.
std::vector<Gaussian> smooth(std::span<const FilterStep> steps);

} // namespace bris
