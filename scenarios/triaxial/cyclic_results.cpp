#include "scenarios/triaxial/cyclic_results.hpp"

#include "engine/io/plot.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

using R = CyclicResponse;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A number of the response in cycle n, which begins with 1.
double in_cycle(const CyclicState& cyclic, double R::*number, std::size_t n) {
    return n > 0 && n <= cyclic.responses.rows() ? cyclic.responses[number][n - 1] : unknown;
}

double worst_ring_error(const CyclicState& cyclic) {
    double worst = 0;
    for (const double error : cyclic.responses[&R::worst_ring_error])
        worst = std::max(worst, error);
    // a specimen that fails has a part of a cycle more
    for (const double error : cyclic.loops[&LoadPoint::worst_ring_error])
        worst = std::max(worst, error);
    return worst;
}

Curve curve_in_percent(const std::string& label, const CyclicState& cyclic, double R::*number) {
    Curve curve{.label = label};
    for (std::size_t n = 1; n <= cyclic.responses.rows(); ++n) {
        curve.x.push_back(static_cast<double>(n));
        curve.y.push_back(100 * in_cycle(cyclic, number, n));
    }
    return curve;
}

Curve modulus_curve(const std::string& label, const CyclicState& cyclic) {
    Curve curve = curve_in_percent(label, cyclic, &R::resilient_modulus);
    for (double& y : curve.y) y /= 1e8; // MPa
    return curve;
}

Curve loops_of(const std::string& label, const CyclicState& cyclic) {
    using P = LoadPoint;
    Curve curve{.label = label};
    const auto &cycle = cyclic.loops[&P::cycle], &strain = cyclic.loops[&P::axial_strain],
               &q = cyclic.loops[&P::q];
    for (std::size_t k = 0; k < cycle.size(); ++k) {
        if (k > 0 && cycle[k] > cycle[k - 1] + 0.9) { // the cycles between are not shown
            curve.x.push_back(unknown);
            curve.y.push_back(unknown);
        }
        curve.x.push_back(100 * strain[k]);
        curve.y.push_back(q[k] / 1e3);
    }
    return curve;
}

} // namespace

std::vector<NamedValue> named_values_of(const CyclicState& cyclic) {
    const std::size_t last = cyclic.responses.rows();
    std::vector<NamedValue> values{{"load_cycles", std::uint64_t(last)}};
    for (std::size_t n = 1; n <= last; n *= 10) {
        values.push_back({fmt::format("axial_strain_after_{}_cycles", n),
                          in_cycle(cyclic, &R::axial_strain, n)});
        values.push_back({fmt::format("volumetric_strain_after_{}_cycles", n),
                          in_cycle(cyclic, &R::volumetric_strain, n)});
    }
    const auto axial = [&](std::size_t n) { return in_cycle(cyclic, &R::axial_strain, n); };
    const auto of_last = [&](double R::*number) { return in_cycle(cyclic, number, last); };
    values.insert(values.end(),
                  {{"permanent_axial_strain", of_last(&R::axial_strain)},
                   {"permanent_volumetric_strain", of_last(&R::volumetric_strain)},
                   {"axial_strain_in_last_decade", axial(last) - axial(last / 10)},
                   {"axial_strain_in_decade_before", axial(last / 10) - axial(last / 100)},
                   {"least_q_Pa", of_last(&R::least_q)},
                   {"largest_q_Pa", of_last(&R::largest_q)},
                   {"resilient_modulus_Pa", of_last(&R::resilient_modulus)},
                   {"resilient_poisson_ratio", of_last(&R::poisson_ratio)},
                   {"damping_ratio", of_last(&R::damping_ratio)},
                   {"worst_ring_pressure_error", worst_ring_error(cyclic)}});
    return values;
}

void write_cycles(const std::filesystem::path& folder, const CyclicState& cyclic) {
    cyclic.responses.write_csv(folder / "cycles.csv");
    cyclic.loops.write_csv(folder / "loops.csv");
}

bool draw_cycles(const std::filesystem::path& png, const std::vector<LabelledCycles>& tests) {
    const auto panel = [](const char* title, const char* y) {
        return Plot{.title = title, .x_label = "load cycle", .y_label = y, .x_logarithmic = true};
    };
    Plot axial = panel("Permanent axial strain", "axial strain (%)");
    Plot volume =
        panel("Permanent volumetric strain (compression positive)", "volumetric strain (%)");
    Plot modulus = panel("Resilient modulus", "MPa");
    Plot damping = panel("Damping ratio of the loop", "%");
    Plot loops{.title = "Loops of cycles 1, 2, 5, 10, 20, ...",
               .x_label = "axial strain (%)",
               .y_label = "q (kPa)"};
    for (const auto& [label, cyclic] : tests) {
        axial.curves.push_back(curve_in_percent(label, *cyclic, &R::axial_strain));
        volume.curves.push_back(curve_in_percent(label, *cyclic, &R::volumetric_strain));
        modulus.curves.push_back(modulus_curve(label, *cyclic));
        damping.curves.push_back(curve_in_percent(label, *cyclic, &R::damping_ratio));
        loops.curves.push_back(loops_of(label, *cyclic));
    }
    return draw_plots(png, {axial, volume, loops, modulus, damping}, 3);
}

} // namespace bris
