#pragma once

#include "engine/io/plot.hpp"
#include "engine/named_value.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <filesystem>
#include <optional>

namespace bris {

/// What a curve says, by fixed definitions. Stresses are those of the boundaries; axial strain is
/// platen travel over the height at the start of shearing; compression is positive.
struct TriaxialProperties {
    double peak_q = 0, strain_at_peak = 0; ///< Pa, -: largest deviatoric stress of any stage
    double mean_q = 0; ///< Pa, mean over the last quarter of the strain (6-8 % of 8 %)
    double initial_modulus =
        0; ///< Pa, rise of q / axial strain at 0.1 % (or the first stage beyond)
    double secant_modulus =
        0; ///< Pa, E50: rise of q / axial strain where q first reaches half its peak
    double poisson_ratio = 0; ///< -, (1 - volumetric / axial strain) / 2 at the strain of E50
    double peak_friction_angle = 0,
           mean_friction_angle = 0;     ///< deg, asin(q / (q + 2 sigma_3)) of peak and mean q
    double final_volumetric_strain = 0; ///< -, negative: dilation
    double largest_dilation_angle =
        0;                  ///< deg, of a line through 1 % of strain: sin = -dev / (2 de1 - dev)
    double bulge_index = 0; ///< -, (dR of the middle rings - dR of the end rings) / mean dR
    double worst_ring_error = 0, mean_ring_error = 0; ///< -, over all stage ends
    double worst_stress_mismatch = 0; ///< -, |boundary - contact| / boundary, axial and radial
    double relative_energy_error = 0; ///< -, |work + scaling - (stored + kinetic) - friction -
                                      ///< damping| / work, over the shearing
    double largest_inertial_number = 0;
};

/// Needs at least two points. Stages before the first equilibrium do not count.
TriaxialProperties properties_of(const std::vector<TriaxialPoint>& points,
                                 double confining_pressure);

/// Flat keys with unit suffixes, for summary.json.
std::vector<NamedValue> describe(const TriaxialProperties& properties);

/// One line for each point, rings included. Throws OutputError.
void write_curve(const std::filesystem::path& csv, const std::vector<TriaxialPoint>& points);

/// One line for each sensor rock: its given and its present pose. Throws OutputError.
void write_sensor_drift(const std::filesystem::path& csv, const World& world);

/// A named curve of one test.
struct TestCurve {
    std::string label;
    const std::vector<TriaxialPoint>* points;
};

/// One number of the points over axial strain (%), and the radial strain (%) of the rings at the
/// end from below, to be drawn.
Curve curve_of(const std::string& label, const std::vector<TriaxialPoint>& points, double scale,
               double TriaxialPoint::*value, Curve::Style style = Curve::Style::line);
Curve profile_of(const std::string& label, const std::vector<TriaxialPoint>& points,
                 Curve::Style style = Curve::Style::line);

/// q, volumetric strain, ring profile and energies of some tests, as one PNG. False if gnuplot
/// fails.
bool draw_curves(const std::filesystem::path& png, const std::vector<TestCurve>& tests);

} // namespace bris
