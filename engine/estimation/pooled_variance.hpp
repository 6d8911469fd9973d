#pragma once

#include <vector>

namespace bris {

/// A variance as estimated, and its degrees of freedom (> 0).
struct EstimatedVariance {
    double variance = 0, degrees = 0;
};

/// Variances of similar quantities, each estimated from few values, pooled as far as they agree: if
/// true variances follow a scaled inverse chi-squared distribution, whose scale and degrees of
/// freedom d0 are estimated by moments of the logarithms, each becomes the mean of its own and of
/// the common one, weighted by degrees of freedom, and has the sum of both (Smyth 2004, "Linear
/// models and empirical Bayes methods", Stat. Appl. Genet. Mol. Biol. 3(1), 3). `most`: largest d0,
/// since few variances show little of how they differ. A variance of 0 is not pooled. Returns them
/// in their order.
std::vector<EstimatedVariance> pooled_variances(std::vector<EstimatedVariance> estimated,
                                                double most);

} // namespace bris
