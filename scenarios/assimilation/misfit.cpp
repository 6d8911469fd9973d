#include "scenarios/assimilation/misfit.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double same_strain = 1e-5; // largest difference between a measurement and its stage

/// Root mean square difference of the displacements of the sensor rocks, where they were measured.
double sensor_difference(const ModelRun& run, const std::vector<SensorTrajectory>& trajectories,
                         const StrainRange& range) {
    double squares = 0, count = 0;
    for (std::size_t s = 0; s < std::min(run.sensors, trajectories.size()); ++s) {
        for (std::size_t k = 0; k < trajectories[s].strain.size(); ++k) {
            const auto stage = stage_at(run.points, trajectories[s].strain[k], same_strain);
            if (!stage || !range.holds(trajectories[s].strain[k]) ||
                !trajectories[s].displacement[k].allFinite())
                continue;
            squares +=
                (run.displacement[*stage][s] - trajectories[s].displacement[k]).squaredNorm();
            ++count;
        }
    }
    return std::sqrt(squares / count);
}

} // namespace

bool StrainRange::holds(double strain) const {
    const double above = from > 0 ? from + same_strain : 0;
    return strain > above && strain <= to + same_strain;
}

std::vector<double> ring_strains(const std::vector<TriaxialPoint>& points, double axial_strain) {
    const auto at = stage_at(points, axial_strain, same_strain);
    const std::vector<double>& start = points.front().ring_radius;
    if (!at || points[*at].ring_radius.size() != start.size()) return {};
    std::vector<double> strains;
    for (std::size_t r = 0; r < start.size(); ++r)
        strains.push_back(points[*at].ring_radius[r] / start[r] - 1);
    return strains;
}

double ring_difference(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return std::nan("");
    double squares = 0, count = 0;
    for (std::size_t r = 0; r < a.size(); ++r) {
        if (!std::isfinite(a[r] - b[r])) continue;
        squares += std::pow(a[r] - b[r], 2);
        ++count;
    }
    return std::sqrt(squares / count);
}

double curve_difference(const std::vector<TriaxialPoint>& curve,
                        const std::vector<TriaxialPoint>& measured, const StrainRange& range,
                        double TriaxialPoint::*value) {
    double squares = 0, count = 0;
    for (const TriaxialPoint& m : measured) {
        const auto stage = stage_at(curve, m.axial_strain, same_strain);
        if (!range.holds(m.axial_strain) || !stage || !std::isfinite(m.*value)) continue;
        squares += std::pow(curve[*stage].*value - m.*value, 2);
        ++count;
    }
    return std::sqrt(squares / count);
}

Misfit misfit_of(const ModelRun& run, const RecordedTest& test, const StrainRange& range) {
    const double end = run.points.back().axial_strain;
    return {
        .q = curve_difference(run.points, test.measured, range, &TriaxialPoint::deviatoric_stress),
        .volumetric_strain =
            curve_difference(run.points, test.measured, range, &TriaxialPoint::volumetric_strain),
        .ring_strain =
            ring_difference(ring_strains(run.points, end), ring_strains(test.measured, end)),
        .sensor_displacement = sensor_difference(run, test.trajectories, range)};
}

} // namespace bris
