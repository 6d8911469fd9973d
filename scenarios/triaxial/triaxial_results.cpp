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

double bulge_index(const TriaxialPoint& first, const TriaxialPoint& last) {
    const std::size_t rings = last.ring_radius.size();
    std::vector<double> widening;
    double mean = 0;
    for (std::size_t r = 0; r < rings; ++r) {
        widening.push_back(last.ring_radius[r] - first.ring_radius[r]);
        mean += widening.back() / static_cast<double>(rings);
    }
    const double middle = 0.5 * (widening[rings / 2 - 1] + widening[rings / 2]);
    return mean != 0 ? (middle - 0.5 * (widening.front() + widening.back())) / mean : 0;
}

double relative_energy_error(const TriaxialPoint& a, const TriaxialPoint& b) {
    const double work = b.boundary_work - a.boundary_work + b.scaling_work - a.scaling_work;
    const double kept = b.stored + b.kinetic - a.stored - a.kinetic;
    const double lost = b.friction_work - a.friction_work + b.damping_work - a.damping_work;
    return work != 0 ? std::abs(work - kept - lost) / std::abs(work) : 0;
}

double largest_dilation_angle(const std::vector<TriaxialPoint>& points) {
    double largest = 0;
    for (std::size_t a = 0, b = 0; b < points.size(); ++b) {
        while (points[b].axial_strain - points[a].axial_strain > 0.01) ++a;
        if (points[b].axial_strain - points[a].axial_strain < 0.009) continue;
        const double axial = points[b].axial_strain - points[a].axial_strain;
        const double volume = points[b].volumetric_strain - points[a].volumetric_strain;
        largest = std::max(largest, -volume / (2 * axial - volume));
    }
    return std::asin(std::min(1.0, largest)) * 180 / pi;
}

void find_moduli(const std::vector<TriaxialPoint>& points, TriaxialProperties& p) {
    const double start = points.front().deviatoric_stress; // consolidation leaves a small q
    for (const TriaxialPoint& x : points) {
        if (p.initial_modulus == 0 && x.axial_strain >= 0.000999)
            p.initial_modulus = (x.deviatoric_stress - start) / x.axial_strain;
        if (p.secant_modulus == 0 && x.axial_strain > 0 && x.deviatoric_stress >= 0.5 * p.peak_q) {
            p.secant_modulus = (x.deviatoric_stress - start) / x.axial_strain;
            p.poisson_ratio = 0.5 * (1 - x.volumetric_strain / x.axial_strain);
        }
    }
}

} // namespace

TriaxialProperties properties_of(const std::vector<TriaxialPoint>& points,
                                 double confining_pressure) {
    TriaxialProperties p;
    const double final_strain = points.back().axial_strain;
    double count = 0;
    for (std::size_t k = 1; k < points.size(); ++k) {
        const TriaxialPoint& x = points[k];
        if (x.deviatoric_stress > p.peak_q) {
            p.peak_q = x.deviatoric_stress;
            p.strain_at_peak = x.axial_strain;
        }
        if (x.axial_strain >= 0.75 * final_strain) {
            p.mean_q += x.deviatoric_stress;
            ++count;
        }
        p.worst_ring_error = std::max(p.worst_ring_error, x.worst_ring_error);
        p.mean_ring_error += x.mean_ring_error / static_cast<double>(points.size() - 1);
        p.worst_stress_mismatch =
            std::max({p.worst_stress_mismatch, std::abs(x.contact_axial / x.boundary_axial - 1),
                      std::abs(x.contact_radial / x.boundary_radial - 1)});
        p.largest_inertial_number = std::max(p.largest_inertial_number, x.inertial_number);
    }
    p.mean_q /= std::max(1.0, count);
    find_moduli(points, p);
    p.peak_friction_angle = friction_angle(p.peak_q, confining_pressure);
    p.mean_friction_angle = friction_angle(p.mean_q, confining_pressure);
    p.final_volumetric_strain = points.back().volumetric_strain;
    p.largest_dilation_angle = largest_dilation_angle(points);
    p.bulge_index = bulge_index(points.front(), points.back());
    p.relative_energy_error = relative_energy_error(points.front(), points.back());
    return p;
}

std::vector<NamedValue> describe(const TriaxialProperties& p) {
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

void write_curve(const std::filesystem::path& csv, const std::vector<TriaxialPoint>& points) {
    std::vector<std::string> names;
    std::vector<std::vector<double>> rows;
    for (TriaxialPoint p : points) {
        std::vector<double> row;
        p.visit([&](const char* name, const char* unit, double value) {
            if (rows.empty()) names.push_back(key_with_unit(name, unit));
            row.push_back(value);
        });
        for (std::size_t r = 0; r < p.ring_radius.size(); ++r) {
            if (rows.empty()) names.push_back("ring_" + std::to_string(r + 1) + "_radius_m");
            row.push_back(p.ring_radius[r]);
        }
        rows.push_back(std::move(row));
    }
    write_csv(csv, names, rows,
              {"one line at the start of shearing and one at the end of each stage; compression is "
               "positive"},
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

std::string label_of(double pressure) { return fmt::format("{:.4g} kPa", pressure / 1e3); }

Curve curve_of(const std::string& label, const std::vector<TriaxialPoint>& points, double scale,
               double TriaxialPoint::*value, Curve::Style style) {
    Curve c{.label = label, .style = style};
    for (const TriaxialPoint& p : points) {
        c.x.push_back(100 * p.axial_strain);
        c.y.push_back(scale * p.*value);
    }
    return c;
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

Curve profile_of(const std::string& label, const std::vector<TriaxialPoint>& points,
                 Curve::Style style) {
    std::vector<double> strains;
    for (std::size_t r = 0; r < points.back().ring_radius.size(); ++r)
        strains.push_back(points.back().ring_radius[r] / points.front().ring_radius[r] - 1);
    return ring_curve(label, strains, style);
}

bool draw_curves(const std::filesystem::path& png, const std::vector<TestCurve>& tests) {
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
    for (const TestCurve& test : tests) {
        Curve work{test.label, {}, {}}, lost{"", {}, {}, Curve::Style::points};
        const TriaxialPoint& first = test.points->front();
        for (const TriaxialPoint& p : *test.points) {
            work.x.push_back(100 * p.axial_strain);
            work.y.push_back(p.boundary_work + p.scaling_work - first.boundary_work -
                             first.scaling_work);
            if ((&p - &first) % 20 != 0) continue; // as dots on the curve of the work
            lost.x.push_back(100 * p.axial_strain);
            lost.y.push_back(p.stored + p.friction_work + p.damping_work - first.stored -
                             first.friction_work - first.damping_work);
        }
        q.curves.push_back(
            curve_of(test.label, *test.points, 1e-3, &TriaxialPoint::deviatoric_stress));
        volume.curves.push_back(
            curve_of(test.label, *test.points, 100, &TriaxialPoint::volumetric_strain));
        rings.curves.push_back(profile_of(test.label, *test.points));
        energy.curves.push_back(work);
        energy.curves.push_back(lost);
    }
    return draw_plots(png, {{q, volume, rings, energy}}, 2);
}

} // namespace bris
