#include "scenarios/triaxial/triaxial_results.hpp"

#include "engine/io/csv.hpp"
#include "engine/math.hpp"
#include "engine/options.hpp"
#include "scenarios/triaxial/specimen_state.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

double friction_angle(double q, double confining_pressure) {
    return std::asin(q / (q + 2 * confining_pressure)) * 180 / pi;
}

double bulge_index(const TestCurves& curves) {
    const std::size_t rings = curves.rings();
    std::vector<double> widening;
    double mean = 0;
    for (std::size_t r = 0; r < rings; ++r) {
        widening.push_back(curves.ring(r).back() - curves.ring(r).front());
        mean += widening.back() / static_cast<double>(rings);
    }
    const double middle = 0.5 * (widening[rings / 2 - 1] + widening[rings / 2]);
    return mean != 0 ? (middle - 0.5 * (widening.front() + widening.back())) / mean : 0;
}

double relative_energy_error(const TestCurves& curves) {
    const auto first = [&](const Quantity& q) { return curves[q].front(); };
    const auto last = [&](const Quantity& q) { return curves[q].back(); };
    using namespace quantity;
    const double work =
        last(boundary_work) - first(boundary_work) + last(scaling_work) - first(scaling_work);
    const double kept =
        last(stored_energy) + last(kinetic_energy) - first(stored_energy) - first(kinetic_energy);
    const double lost =
        last(friction_work) - first(friction_work) + last(damping_work) - first(damping_work);
    return work != 0 ? std::abs(work - kept - lost) / std::abs(work) : 0;
}

double largest_dilation_angle(const TestCurves& curves) {
    const auto &strain = curves[quantity::axial_strain],
               &volumetric = curves[quantity::volumetric_strain];
    double largest = 0;
    for (std::size_t a = 0, b = 0; b < curves.size(); ++b) {
        while (strain[b] - strain[a] > 0.01) ++a;
        if (strain[b] - strain[a] < 0.009) continue;
        const double axial = strain[b] - strain[a], volume = volumetric[b] - volumetric[a];
        largest = std::max(largest, -volume / (2 * axial - volume));
    }
    return std::asin(std::min(1.0, largest)) * 180 / pi;
}

void find_moduli(const TestCurves& curves, TriaxialProperties& p) {
    const auto &strain = curves[quantity::axial_strain], &q = curves[quantity::deviatoric_stress];
    for (std::size_t k = 0; k < curves.size(); ++k) {
        const double rise = q[k] - q.front(); // consolidation leaves a small q
        if (p.initial_modulus == 0 && strain[k] >= 0.000999) p.initial_modulus = rise / strain[k];
        if (p.secant_modulus == 0 && strain[k] > 0 && q[k] >= 0.5 * p.peak_q) {
            p.secant_modulus = rise / strain[k];
            p.poisson_ratio = 0.5 * (1 - curves[quantity::volumetric_strain][k] / strain[k]);
        }
    }
}

} // namespace

TriaxialProperties properties_of(const TestCurves& curves, double confining_pressure) {
    TriaxialProperties p;
    const auto &strain = curves[quantity::axial_strain], &q = curves[quantity::deviatoric_stress];
    double count = 0;
    for (std::size_t k = 1; k < curves.size(); ++k) {
        const auto at = [&](const Quantity& x) { return curves[x][k]; };
        using namespace quantity;
        if (q[k] > p.peak_q) {
            p.peak_q = q[k];
            p.strain_at_peak = strain[k];
        }
        if (strain[k] >= 0.75 * strain.back()) {
            p.mean_q += q[k];
            ++count;
        }
        p.worst_ring_error = std::max(p.worst_ring_error, at(worst_ring_error));
        p.mean_ring_error += at(mean_ring_error) / static_cast<double>(curves.size() - 1);
        p.worst_stress_mismatch =
            std::max({p.worst_stress_mismatch,
                      std::abs(at(contact_stress_axial) / at(boundary_stress_axial) - 1),
                      std::abs(at(contact_stress_radial) / at(boundary_stress_radial) - 1)});
        p.largest_inertial_number = std::max(p.largest_inertial_number, at(inertial_number));
    }
    p.mean_q /= std::max(1.0, count);
    find_moduli(curves, p);
    p.peak_friction_angle = friction_angle(p.peak_q, confining_pressure);
    p.mean_friction_angle = friction_angle(p.mean_q, confining_pressure);
    p.final_volumetric_strain = curves[quantity::volumetric_strain].back();
    p.largest_dilation_angle = largest_dilation_angle(curves);
    p.bulge_index = bulge_index(curves);
    p.relative_energy_error = relative_energy_error(curves);
    return p;
}

std::vector<NamedValue> named_values_of(const TriaxialProperties& p) {
    return {{"peak_q_Pa", p.peak_q},
            {"strain_at_peak", p.strain_at_peak},
            {"mean_q_last_quarter_Pa", p.mean_q},
            {"initial_modulus_Pa", p.initial_modulus},
            {"secant_modulus_E50_Pa", p.secant_modulus},
            {"poisson_ratio_E50", p.poisson_ratio},
            {"peak_friction_angle_deg", p.peak_friction_angle},
            {"mean_friction_angle_deg", p.mean_friction_angle},
            {"final_volumetric_strain", p.final_volumetric_strain},
            {"largest_dilation_angle_deg", p.largest_dilation_angle},
            {"bulge_index", p.bulge_index},
            {"mean_ring_pressure_error", p.mean_ring_error},
            {"worst_ring_pressure_error", p.worst_ring_error},
            {"worst_boundary_contact_stress_mismatch", p.worst_stress_mismatch},
            {"relative_energy_error", p.relative_energy_error},
            {"largest_inertial_number", p.largest_inertial_number}};
}

void write_stages(const std::filesystem::path& csv, const TestCurves& curves) {
    write_curves(csv, curves, {quantity::of_stage.begin(), quantity::of_stage.end()},
                 "one line at the start of shearing and one at the end of each stage; compression "
                 "is positive",
                 9);
}

void write_sensor_drift(const std::filesystem::path& csv, const World& world) {
    std::vector<std::vector<double>> rows;
    for (const SensorDrift& d : sensor_drift(world))
        rows.push_back({static_cast<double>(rows.size() + 1), static_cast<double>(d.body),
                        d.given.x(), d.given.y(), d.given.z(), d.now.x(), d.now.y(), d.now.z(),
                        (d.now - d.given).norm(), d.rotation * 180 / pi});
    write_csv(
        csv,
        {"sensor", "body", "given_x_m", "given_y_m", "given_z_m", "x_m", "y_m", "z_m", "drift_m",
         "rotation_deg"},
        rows,
        {"poses of the sensor rocks at the start of shearing, compared with their given poses",
         "sensor: numbered from 1; body: number in the run file, whose bodies are numbered from 0"},
        9);
}

Curve ring_curve(const std::string& label, const std::vector<double>& radial_strains,
                 Curve::Style style) {
    Curve c{.label = label, .style = style};
    for (std::size_t r = 0; r < radial_strains.size(); ++r) {
        c.x.push_back(100 * radial_strains[r]);
        c.y.push_back(static_cast<double>(r + 1));
    }
    return c;
}

Curve profile_of(const std::string& label, const TestCurves& curves, Curve::Style style) {
    std::vector<double> strains;
    for (std::size_t r = 0; r < curves.rings(); ++r)
        strains.push_back(curves.ring(r).back() / curves.ring(r).front() - 1);
    return ring_curve(label, strains, style);
}

bool draw_curves(const std::filesystem::path& png, const std::vector<LabelledCurves>& tests) {
    Plot q{"Deviatoric stress", "axial strain (%)", "q (kPa)", {}};
    Plot volume{"Volumetric strain (compression positive)",
                "axial strain (%)",
                "volumetric strain (%)",
                {}};
    Plot rings{"Radial strain of the rings at the end of the test",
               "radial strain, widening positive (%)",
               "ring, from below",
               {}};
    Plot energy{"Work of the boundaries (dots: stored energy + friction + damping)",
                "axial strain (%)",
                "J",
                {}};
    for (const auto& [label, curves] : tests) {
        Curve work{label, {}, {}}, lost{"", {}, {}, Curve::Style::points};
        for (std::size_t k = 0; k < curves->size(); ++k) {
            const auto since_start = [&](std::initializer_list<const Quantity*> quantities) {
                double sum = 0, before = 0;
                for (const Quantity* x : quantities) {
                    sum += (*curves)[*x][k];
                    before += (*curves)[*x].front();
                }
                return sum - before;
            };
            using namespace quantity;
            work.x.push_back(100 * (*curves)[axial_strain][k]);
            work.y.push_back(since_start({&boundary_work, &scaling_work}));
            if (k % 20 != 0) continue; // as dots on the curve of the work
            lost.x.push_back(work.x.back());
            lost.y.push_back(since_start({&stored_energy, &friction_work, &damping_work}));
        }
        q.curves.push_back(curve_of(label, *curves, quantity::deviatoric_stress));
        volume.curves.push_back(curve_of(label, *curves, quantity::volumetric_strain));
        rings.curves.push_back(profile_of(label, *curves));
        energy.curves.push_back(work);
        energy.curves.push_back(lost);
    }
    return draw_plots(png, {{q, volume, rings, energy}}, 2);
}

} // namespace bris
