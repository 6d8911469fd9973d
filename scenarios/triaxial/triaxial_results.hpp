#pragma once

#include "engine/named_value.hpp"
#include "scenarios/records/draw_curves.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <filesystem>
#include <optional>

namespace bris {

/// Properties of a stress-strain curve. Stresses are those of the boundaries; axial strain is the
/// displacement of the platen over the height at the start of shearing; compression is positive.
struct TriaxialProperties {
    /// Pa and -, largest deviatoric stress of any stage and its axial strain.
    double peak_q = 0, strain_at_peak = 0;
    /// Pa, mean over the last quarter of the strain (6-8 % of 8 %).
    double mean_q = 0;
    /// Pa, rise of q / axial strain at 0.1 % (or the first stage beyond).
    double initial_modulus = 0;
    /// Pa, E50: rise of q / axial strain where q first reaches half its peak.
    double secant_modulus = 0;
    /// -, (1 - volumetric / axial strain) / 2 at the strain of E50.
    double poisson_ratio = 0;
    /// deg, asin(q / (q + 2 sigma_3)) of peak and mean q.
    double peak_friction_angle = 0, mean_friction_angle = 0;
    double final_volumetric_strain = 0; ///< -, negative: dilation
    /// deg, of a secant over 1 % of axial strain: sin = -dev / (2 de1 - dev).
    double largest_dilation_angle = 0;
    double bulge_index = 0; ///< -, (dR of the middle rings - dR of the end rings) / mean dR
    double worst_ring_error = 0, mean_ring_error = 0; ///< -, over all stage ends
    double worst_stress_mismatch = 0; ///< -, |boundary - contact| / boundary, axial and radial
    /// -, |work + scaling - (stored + kinetic) - friction - damping| / work, over the shearing.
    double relative_energy_error = 0;
    double largest_inertial_number = 0;
};

/// Properties of a test from its stages, at least two. The first row, the end of consolidation,
/// counts only as the origin.
TriaxialProperties properties_of(const TestCurves& curves, double confining_pressure);

/// The properties as flat keys with unit suffixes, for summary.json.
std::vector<NamedValue> named_values_of(const TriaxialProperties& properties);

/// Writes a CSV file with one line for each stage, rings included. Throws OutputError.
void write_stages(const std::filesystem::path& csv, const TestCurves& curves);

/// Writes a CSV file with the given and the present pose of each sensor rock. Throws OutputError.
void write_sensor_drift(const std::filesystem::path& csv, const World& world);

/// The curves of one test, with their label.
struct LabelledCurves {
    std::string label;
    const TestCurves* curves;
};

/// Radial strains against the number of the ring, from below; drawn in per cent.
Curve ring_curve(const std::string& label, const std::vector<double>& radial_strains,
                 Curve::Style style = Curve::Style::line);
/// Radial strain (%) of the rings at the last stage, numbered from below.
Curve profile_of(const std::string& label, const TestCurves& curves,
                 Curve::Style style = Curve::Style::line);

/// Draws q, volumetric strain, ring profile and energies of some tests as one PNG file. Returns
/// false if gnuplot fails.
bool draw_curves(const std::filesystem::path& png, const std::vector<LabelledCurves>& tests);

} // namespace bris
