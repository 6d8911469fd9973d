#pragma once

#include "scenarios/field_tests/shear_box.hpp"

#include <span>
#include <vector>

namespace bris {

/// What a curve of a direct shear test shows. Shear stresses are those at the plane between the
/// halves. Normal stresses are those of the plate and of the rocks above that plane, as tests state
/// them; across the plane acts more, because the flange of the upper half holds rocks down.
struct ShearProperties {
    double peak_stress = 0,
           peak_normal = 0;       ///< Pa, largest mean over a window; normal stress there
    double peak_plane_normal = 0; ///< Pa, across the plane at the peak
    double peak_displacement = 0; ///< m
    double residual_stress = 0, residual_normal = 0; ///< Pa, mean of the last fifth
    double dilation = 0;                             ///< m, at the end
    double dilation_angle = 0; ///< degrees, largest over three windows of displacement
    /// Largest over the windows of |shear force of lower - of upper half| over their mean at the
    /// peak, and of the vertical forces that are not balanced over the vertical force.
    double shear_imbalance = 0, normal_imbalance = 0;
    double energy_error = 0; ///< what is missing in the energy budget over the work put in
    double inertial_number = 0;
    double peak_ratio() const { return peak_stress / peak_normal; }
    double residual_ratio() const { return residual_stress / residual_normal; }
    double peak_angle() const;       ///< degrees
    double peak_plane_angle() const; ///< degrees, from the stresses across the plane
    double residual_angle() const;   ///< degrees
};

/// Properties of a curve with the columns of shear_columns; forces are averaged over windows of
/// `window` (m) of displacement.
ShearProperties properties_of(const SeriesOf<ShearSample>& curve, double window = 1e-3);

/// Strength against normal stress (Pa): Mohr-Coulomb, cohesion + normal tan(angle), and the power
/// law factor * normal^exponent, by least squares (of logarithms for the power law).
struct StrengthFit {
    double cohesion = 0, angle = 0;  ///< Pa, degrees
    double factor = 0, exponent = 0; ///< Pa^(1 - exponent), -
};
/// Needs two or more different normal stresses.
StrengthFit fit_strength(std::span<const double> normal, std::span<const double> strength);

} // namespace bris
