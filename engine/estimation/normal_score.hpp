#pragma once

namespace bris {

/// Probability that a standard normal variable is below z.
double normal_probability(double z);

/// Continuous ranked probability score of a normal forecast with this standard deviation (> 0)
/// whose mean is off by `error`, in the unit of both; the mean of many scores is smallest for the
/// true distribution (Gneiting and Raftery 2007, J. Am. Stat. Assoc. 102:359, section 4.2).
double normal_crps(double error, double deviation);

} // namespace bris
