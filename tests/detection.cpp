#include "tests/detection.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"

#include <boost/math/special_functions/beta.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace bris {

namespace {

void require_scores(std::span<const double> unchanged, std::span<const double> changed) {
    const auto is_nan = [](double score) { return std::isnan(score); };
    require(!unchanged.empty() && !changed.empty() && std::ranges::none_of(unchanged, is_nan) &&
                std::ranges::none_of(changed, is_nan),
            "detection: expected scores of both groups, found none, or one that is not a number");
}

} // namespace

ConfidenceInterval binomial_interval(std::size_t successes, std::size_t trials, double confidence) {
    require(successes <= trials && trials > 0 && confidence > 0 && confidence < 1,
            fmt::format("binomial interval: expected successes among at least one trial, found {} "
                        "of {}",
                        successes, trials));
    const auto k = static_cast<double>(successes), n = static_cast<double>(trials);
    const double tail = (1 - confidence) / 2;
    return {successes == 0 ? 0 : boost::math::ibeta_inv(k, n - k + 1, tail),
            successes == trials ? 1 : boost::math::ibeta_inv(k + 1, n - k, 1 - tail)};
}

std::vector<RocPoint> roc_curve(std::span<const double> unchanged,
                                std::span<const double> changed) {
    require_scores(unchanged, changed);
    std::vector<double> a(unchanged.begin(), unchanged.end()), b(changed.begin(), changed.end()),
        thresholds = a;
    thresholds.insert(thresholds.end(), b.begin(), b.end());
    for (auto* scores : {&a, &b, &thresholds}) std::ranges::sort(*scores, std::greater<>());
    thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
    const auto above = [](const std::vector<double>& scores, double threshold) {
        const auto end = std::ranges::lower_bound(scores, threshold, std::greater<>());
        return static_cast<double>(end - scores.begin()) / static_cast<double>(scores.size());
    };
    std::vector<RocPoint> curve;
    for (const double t : thresholds) curve.push_back({t, above(a, t), above(b, t)});
    curve.push_back({-std::numeric_limits<double>::infinity(), 1, 1});
    return curve;
}

double area_under_roc(std::span<const double> unchanged, std::span<const double> changed) {
    require_scores(unchanged, changed);
    std::vector<double> sorted(unchanged.begin(), unchanged.end());
    std::ranges::sort(sorted);
    double sum = 0;
    for (const double score : changed) {
        const auto equal = std::ranges::equal_range(sorted, score);
        sum += static_cast<double>(equal.begin() - sorted.begin()) +
               0.5 * static_cast<double>(equal.size());
    }
    return sum / static_cast<double>(sorted.size()) / static_cast<double>(changed.size());
}

ConfidenceInterval bootstrap_area_under_roc(std::span<const double> unchanged,
                                            std::span<const double> changed, double confidence,
                                            std::size_t draws, std::uint64_t seed) {
    require_scores(unchanged, changed);
    require(draws > 0 && confidence > 0 && confidence < 1,
            "bootstrap: expected at least one draw and a confidence between 0 and 1");
    std::vector<double> areas;
    const auto resampled = [](std::span<const double> scores, Random& random) {
        std::vector<double> sample;
        for (std::size_t k = 0; k < scores.size(); ++k)
            sample.push_back(scores[static_cast<std::size_t>(random.uniform() *
                                                             static_cast<double>(scores.size()))]);
        return sample;
    };
    for (std::size_t draw = 0; draw < draws; ++draw) {
        Random random(seed, draw);
        const auto a = resampled(unchanged, random), b = resampled(changed, random);
        areas.push_back(area_under_roc(a, b));
    }
    std::ranges::sort(areas);
    const auto quantile = [&](double p) {
        return areas[static_cast<std::size_t>(p * static_cast<double>(draws - 1) + 0.5)];
    };
    return {quantile((1 - confidence) / 2), quantile((1 + confidence) / 2)};
}

} // namespace bris
