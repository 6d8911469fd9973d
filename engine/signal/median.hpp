#pragma once

#include "engine/math.hpp"

#include <algorithm>
#include <vector>

namespace bris {

/// Median of at least one value; for an even number, the upper of the two middle values. Up to half
/// of the values may be wrong without moving it far.
inline double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Value below which a share (0 to 1) of at least one value lies, between two values in proportion.
inline double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    const double at = share * static_cast<double>(values.size() - 1);
    const auto k = static_cast<std::size_t>(at);
    const double next = values[std::min(k + 1, values.size() - 1)];
    return values[k] + (at - static_cast<double>(k)) * (next - values[k]);
}

/// Median of each component.
inline Vec3 median(const std::vector<Vec3>& values) {
    Vec3 middle;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<double> one;
        for (const Vec3& v : values) one.push_back(v[axis]);
        middle[axis] = median(std::move(one));
    }
    return middle;
}

/// Standard deviation of normally distributed values with mean 0, from the median of their absolute
/// values.
inline double deviation_of_median(double median_of_absolutes) {
    return 1.4826 * median_of_absolutes;
}

} // namespace bris
