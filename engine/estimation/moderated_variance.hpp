#pragma once

#include <vector>

namespace bris {

/// Improves variances of similar quantities that are each estimated as a mean of few squares
/// (`freedom` degrees of freedom, > 0). The logarithms of the variances are shrunk towards their
/// mean, the more the closer their spread is to the sampling scatter of such estimates (James and
/// Stein's estimator; Cui et al. 2005, "Improved statistical tests for differential gene expression
/// by shrinking variance components estimates", Biostatistics 6). Variances of 0 belong to
/// quantities that cannot vary, and stay 0. Fewer than four positive variances are returned
/// unchanged.
std::vector<double> moderated_variances(std::vector<double> variances, double freedom);

} // namespace bris
