#include "scenarios/field_tests/shear_results.hpp"

#include "engine/math.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bris {

namespace {

constexpr double degree = pi / 180;

double mean(const std::vector<double>& v, std::size_t first, std::size_t last) {
    return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(first),
                           v.begin() + static_cast<std::ptrdiff_t>(last), 0.0) /
           static_cast<double>(last - first);
}

double energy_error(const SeriesOf<ShearSample>& c) {
    using S = ShearSample;
    const auto change = [&](double S::*number) { return c[number].back() - c[number].front(); };
    const double work = change(&S::work_put_in);
    const double missing = work - change(&S::energy_stored) - change(&S::work_lost);
    return work != 0 ? std::abs(missing / work) : 0;
}

} // namespace

double ShearProperties::peak_angle() const { return std::atan2(peak_stress, peak_normal) / degree; }
double ShearProperties::peak_plane_angle() const {
    return std::atan2(peak_stress, peak_plane_normal) / degree;
}
double ShearProperties::residual_angle() const {
    return std::atan2(residual_stress, residual_normal) / degree;
}

ShearProperties properties_of(const SeriesOf<ShearSample>& c, double window) {
    using S = ShearSample;
    const auto &x = c[&S::displacement], &shear = c[&S::shear_stress],
               &normal = c[&S::normal_stress], &dilation = c[&S::dilation],
               &lower = c[&S::shear_force_lower_half], &upper = c[&S::shear_force_upper_half],
               &down = c[&S::normal_force_lower_half], &up = c[&S::normal_force_upper_half],
               &weight = c[&S::weight_of_rocks];
    ShearProperties p;
    const std::size_t n = x.size();
    double imbalance = 0, at_peak = 0;
    for (std::size_t a = 1, b = 1; b < n; ++b) {
        while (x[b] - x[a - 1] > window * (1 + 1e-6)) ++a;
        if (x[b] - x[a - 1] < 0.9 * window) continue;
        const double now = mean(shear, a, b + 1);
        const double f = 0.5 * (mean(lower, a, b + 1) + mean(upper, a, b + 1));
        imbalance = std::max(imbalance, std::abs(mean(lower, a, b + 1) - mean(upper, a, b + 1)));
        const double vertical = mean(down, a, b + 1);
        p.normal_imbalance =
            std::max(p.normal_imbalance,
                     std::abs(vertical - mean(up, a, b + 1) - mean(weight, a, b + 1)) / vertical);
        if (now <= p.peak_stress) continue;
        p.peak_stress = now;
        p.peak_normal = mean(normal, a, b + 1);
        p.peak_plane_normal = mean(c[&S::plane_normal_stress], a, b + 1);
        p.peak_displacement = x[b];
        at_peak = f;
    }
    p.shear_imbalance = at_peak > 0 ? imbalance / at_peak : 0;
    for (std::size_t a = 0, b = 1; b < n; ++b) {
        while (x[b] - x[a] > 3 * window * (1 + 1e-6)) ++a;
        if (x[b] - x[a] < 2.7 * window) continue;
        p.dilation_angle =
            std::max(p.dilation_angle, std::atan2(dilation[b] - dilation[a], x[b] - x[a]) / degree);
    }
    const auto tail = static_cast<std::size_t>(0.8 * static_cast<double>(n));
    p.residual_stress = mean(shear, tail, n);
    p.residual_normal = mean(normal, tail, n);
    p.dilation = dilation.back();
    p.energy_error = energy_error(c);
    p.inertial_number = std::ranges::max(c[&S::inertial_number]);
    return p;
}

StrengthFit fit_strength(std::span<const double> normal, std::span<const double> strength) {
    const auto line = [](std::span<const double> x, std::span<const double> y) {
        const double n = static_cast<double>(x.size());
        const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n,
                     my = std::accumulate(y.begin(), y.end(), 0.0) / n;
        double xx = 0, xy = 0;
        for (std::size_t k = 0; k < x.size(); ++k) {
            xx += (x[k] - mx) * (x[k] - mx);
            xy += (x[k] - mx) * (y[k] - my);
        }
        return std::pair(my - xy / xx * mx, xy / xx); // intercept, slope
    };
    StrengthFit fit;
    const auto [cohesion, slope] = line(normal, strength);
    fit.cohesion = cohesion;
    fit.angle = std::atan(slope) / degree;
    std::vector<double> lx, ly;
    for (const double v : normal) lx.push_back(std::log(v));
    for (const double v : strength) ly.push_back(std::log(v));
    const auto [intercept, exponent] = line(lx, ly);
    fit.factor = std::exp(intercept);
    fit.exponent = exponent;
    return fit;
}

} // namespace bris
