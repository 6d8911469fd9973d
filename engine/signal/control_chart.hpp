#pragma once

#include "engine/signal/spectrum.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace bris {

/// Constants of control charts for subgroups of n independent normal values (Montgomery,
/// Introduction to Statistical Quality Control, appendix VI): means of standard deviation (c4) and
/// range (d2) and deviation of the range (d3) over the deviation of a value, and factors of
/// three-sigma limits.
struct ChartConstants {
    double c4, d2, d3;
    double A2, A3;         ///< limits of the mean by the mean range, and by the mean deviation
    double B3, B4, D3, D4; ///< limits of the standard deviation, and of the range
};
/// Computed from the closed form of c4 and by integration for the range, with an error below 1e-8.
/// Throws InputError unless 2 <= n <= 100.
ChartConstants chart_constants(std::size_t n);

/// Means, and standard deviations (divisor n - 1), of subgroups of n successive values; what
/// remains at the end of a run is left out.
std::vector<double> subgroup_means(Runs runs, std::size_t n);
std::vector<double> subgroup_deviations(Runs runs, std::size_t n);

/// A Shewhart chart of points with a mean and a standard deviation: a point outside centre +- width
/// deviations is an outlier.
struct ControlChart {
    double centre = 0, deviation = 1, width = 3;
    double lower() const { return centre - width * deviation; }
    double upper() const { return centre + width * deviation; }
    double standardised(double point) const { return (point - centre) / deviation; }
    bool is_outlier(double point) const { return std::abs(point - centre) > width * deviation; }
};

/// Whether the limits of a chart of subgroup means hold for independent values only, or are
/// corrected by the autocorrelations of the values at lags below the size of a subgroup.
enum class ControlLimits { independent, corrected };

/// Chart of the means of subgroups of n, by the mean and the standard deviation s of all values of
/// the baseline: limits +- width s / sqrt(n), or +- width s sqrt(f / n) with f =
/// variance_factor_of_mean. Throws InputError if the baseline has no subgroup, or does not vary.
ControlChart mean_chart(Runs baseline, std::size_t n, double width, ControlLimits limits);
/// Chart of the logarithms of the standard deviations of subgroups, by their own mean and standard
/// deviation, which contain every dependence and every change of level of the baseline. Throws
/// InputError if the baseline has fewer than two subgroups that vary.
ControlChart deviation_chart(Runs baseline, std::size_t n, double width);

} // namespace bris
