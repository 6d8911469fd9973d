#include "scenarios/monitoring/report_rule.hpp"

#include "scenarios/monitoring/vibration.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

using RunList = std::vector<std::vector<double>>;

constexpr std::size_t order_of_windows = 5;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

RunList residuals_of_runs(const ArModel& model, Runs runs) {
    RunList residuals;
    for (const auto& run : runs) residuals.push_back(residuals_of(model, run));
    return residuals;
}

RunList standardised(Runs runs) {
    const Moments moments = moments_of(runs);
    RunList all(runs.begin(), runs.end());
    for (auto& run : all)
        for (double& x : run) x = (x - moments.mean) / std::sqrt(moments.square);
    return all;
}

RunList joined(const std::vector<RunList>& passages) {
    RunList all;
    for (const RunList& runs : passages) all.insert(all.end(), runs.begin(), runs.end());
    return all;
}

} // namespace

double ChartPoints::outlier_share(double width) const {
    if (means.empty()) return unknown;
    std::size_t outliers = 0;
    for (std::size_t k = 0; k < means.size(); ++k)
        outliers += !(std::abs(means[k]) <= width && std::abs(deviations[k]) <= width);
    return static_cast<double>(outliers) / static_cast<double>(means.size());
}

/// The coefficients of a model of each window.
RunList ReportRule::window_coefficients(Runs runs) const {
    const std::size_t length = std::size_t{10} * settings_.subgroup;
    RunList all;
    for (const auto& run : runs)
        for (std::size_t first = 0; first + length <= run.size(); first += length) {
            const auto begin = run.begin() + static_cast<std::ptrdiff_t>(first);
            const RunList window{{begin, begin + static_cast<std::ptrdiff_t>(length)}};
            if (std::ranges::adjacent_find(window[0], std::not_equal_to{}) == window[0].end())
                all.emplace_back(order_of_windows, unknown); // a constant window is an outlier
            else
                all.push_back(burg(window, order_of_windows).back().coefficients);
        }
    return all;
}

ReportRule::ReportRule(const ArModel& model, const std::vector<RunList>& passages,
                       const ReportRuleSettings& settings)
    : settings_(settings) {
    const auto residual_charts = [&](const ArModel& of, const RunList& runs) {
        const RunList residuals = residuals_of_runs(of, runs);
        return Residuals{
            of, mean_chart(residuals, settings.subgroup, settings.width, ControlLimits::corrected),
            deviation_chart(residuals, settings.subgroup, settings.width)};
    };
    const auto coefficient_charts = [&](const RunList& runs) {
        const RunList all = window_coefficients(runs);
        Coefficients c;
        if (all.size() < 2) return c;
        const auto n = static_cast<double>(all.size());
        for (std::size_t i = 0; i < order_of_windows; ++i) {
            double sum = 0, squares = 0;
            for (const auto& one : all) sum += one[i];
            for (const auto& one : all) squares += (one[i] - sum / n) * (one[i] - sum / n);
            c.means.push_back(sum / n);
            c.deviations.push_back(std::sqrt(squares / (n - 1)));
        }
        return c;
    };
    std::vector<RunList> alike;
    for (const RunList& runs : passages) alike.push_back(standardised(runs));
    const RunList plain = joined(passages), other = joined(alike);
    plain_ = residual_charts(model, plain);
    standardised_ = residual_charts(burg(other, model.order()).back(), other);
    coefficients_ = coefficient_charts(plain);
}

ChartPoints ReportRule::points(const Residuals& charts, Runs runs) const {
    const RunList residuals = residuals_of_runs(charts.model, runs);
    ChartPoints points;
    for (const double mean : subgroup_means(residuals, settings_.subgroup))
        points.means.push_back(charts.means.standardised(mean));
    // a constant subgroup is an outlier
    for (const double s : subgroup_deviations(residuals, settings_.subgroup))
        points.deviations.push_back(charts.deviations.standardised(std::log(s)));
    return points;
}

ChartPoints ReportRule::points(Runs runs, double rate, const std::vector<double>& begins) const {
    ChartPoints all = points(plain_, runs);
    const std::size_t n = settings_.subgroup, order = plain_.model.order();
    for (std::size_t r = 0; r < std::min(runs.size(), begins.size()); ++r)
        for (std::size_t first = order; first + n <= runs[r].size(); first += n)
            all.times.push_back(
                begins[r] + (static_cast<double>(first) + 0.5 * static_cast<double>(n - 1)) / rate);
    return all;
}

double ReportRule::outlier_share(const Coefficients& charts, Runs runs) const {
    if (charts.means.empty()) return unknown;
    double outliers = 0, all = 0;
    for (const auto& window : window_coefficients(runs)) {
        bool is_within = true;
        for (std::size_t i = 0; i < window.size(); ++i)
            is_within = is_within && std::abs(window[i] - charts.means[i]) <=
                                         settings_.width * charts.deviations[i];
        outliers += !is_within;
        ++all;
    }
    return outliers / all; // NaN without windows
}

std::array<double, readings.size()> ReportRule::outlier_shares(Runs runs) const {
    const RunList alike = standardised(runs);
    return {points(plain_, runs).outlier_share(settings_.width),
            points(standardised_, alike).outlier_share(settings_.width),
            outlier_share(coefficients_, runs)};
}

} // namespace bris
