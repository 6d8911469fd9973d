#pragma once

#include <vector>

namespace bris {

/// Variances of many that are like each other, each known from a mean of few squares (`freedom` of
/// them, above 0): their logarithms, which such means scatter by alike, drawn towards their mean as
/// far as they differ by no more than that (James and Stein's estimator; Cui et al. 2005, "Improved
/// statistical tests for differential gene expression by shrinking variance components estimates",
/// Biostatistics 6). Those that are 0 are of what cannot move, and stay 0.
std::vector<double> moderated_variances(std::vector<double> variances, double freedom);

} // namespace bris
