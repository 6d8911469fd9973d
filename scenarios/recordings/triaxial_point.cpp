#include "scenarios/recordings/triaxial_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace bris {

void save_points(Archive& archive, const std::string& path,
                 const std::vector<TriaxialPoint>& points) {
    std::vector<double> curve, rings;
    for (TriaxialPoint p : points) {
        p.visit([&](auto&&, auto&&, double value) { curve.push_back(value); });
        rings.insert(rings.end(), p.ring_radius.begin(), p.ring_radius.end());
    }
    archive.put(path + "/curve", std::span<const double>(curve));
    archive.put(path + "/ring_radius", std::span<const double>(rings));
}

std::vector<TriaxialPoint> load_points(const Archive& archive, const std::string& path) {
    const auto curve = archive.get<double>(path + "/curve"),
               rings = archive.get<double>(path + "/ring_radius");
    std::size_t numbers = 0;
    TriaxialPoint{}.visit([&](auto&&, auto&&, double&) { ++numbers; });
    std::vector<TriaxialPoint> points(curve.size() / numbers);
    auto next = curve.begin();
    for (std::size_t k = 0; k < points.size(); ++k) {
        points[k].visit([&](auto&&, auto&&, double& value) { value = *next++; });
        const std::size_t each = rings.size() / points.size();
        points[k].ring_radius.assign(rings.begin() + static_cast<std::ptrdiff_t>(k * each),
                                     rings.begin() + static_cast<std::ptrdiff_t>((k + 1) * each));
    }
    return points;
}

std::optional<std::size_t> stage_at(const std::vector<TriaxialPoint>& points, double strain,
                                    double tolerance) {
    auto nearest = std::ranges::lower_bound(points, strain, {}, &TriaxialPoint::axial_strain);
    if (nearest != points.begin() &&
        (nearest == points.end() ||
         strain - std::prev(nearest)->axial_strain < nearest->axial_strain - strain))
        --nearest;
    if (nearest == points.end() || std::abs(nearest->axial_strain - strain) > tolerance)
        return std::nullopt;
    return static_cast<std::size_t>(nearest - points.begin());
}

std::string folder_of(double pressure) { return fmt::format("{:.4g}kPa", pressure / 1e3); }

} // namespace bris
