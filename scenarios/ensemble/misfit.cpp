#include "scenarios/ensemble/misfit.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double same_strain = 1e-5; // largest difference between a measurement and its stage

/// Root mean square difference of the displacements of the sensor rocks, where they were measured.
double sensor_difference(const ModelRun& run, const std::vector<SensorTrajectory>& trajectories,
                         const StrainRange& range) {
    const MonotonicStage stages(run.curves);
    double squares = 0, count = 0;
    for (std::size_t s = 0; s < std::min(run.sensors, trajectories.size()); ++s) {
        for (std::size_t k = 0; k < trajectories[s].strain.size(); ++k) {
            const auto stage = stages.nearest(trajectories[s].strain[k], same_strain);
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

std::vector<double> ring_strains(const TestCurves& curves, double axial_strain) {
    const auto row = MonotonicStage(curves).nearest(axial_strain, same_strain);
    std::vector<double> strains;
    for (std::size_t r = 0; row && r < curves.rings(); ++r)
        strains.push_back(curves.ring(r)[*row] / curves.ring(r).front() - 1);
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

double curve_difference(const MeasuredCurves& measured, const TestCurves& predicted,
                        const StrainRange& range, const Quantity& q) {
    const MonotonicStage stages(predicted);
    const auto &strain = measured[quantity::axial_strain], &found = measured[q],
               &expected = predicted[q];
    double squares = 0, count = 0;
    for (std::size_t k = 0; k < measured.size(); ++k) {
        const auto stage = stages.nearest(strain[k], same_strain);
        if (!range.holds(strain[k]) || !stage || !std::isfinite(found[k])) continue;
        squares += std::pow(expected[*stage] - found[k], 2);
        ++count;
    }
    return std::sqrt(squares / count);
}

Misfit misfit_of(const Measurements& test, const ModelRun& run, const StrainRange& range) {
    const double end = run.curves[quantity::axial_strain].back();
    const auto difference = [&](const Quantity& q) {
        return curve_difference(test.curves, run.curves, range, q);
    };
    return {.q = difference(quantity::deviatoric_stress),
            .volumetric_strain = difference(quantity::volumetric_strain),
            .ring_strain =
                ring_difference(ring_strains(test.curves, end), ring_strains(run.curves, end)),
            .sensor_displacement = sensor_difference(run, test.trajectories, range)};
}

} // namespace bris
