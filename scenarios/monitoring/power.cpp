#include "scenarios/monitoring/power.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/monitoring/comparison.hpp"
#include "scenarios/monitoring/features.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// A chi-squared variable over its degrees of freedom (Wilson and Hilferty 1931).
double variance_factor(Random& random, double degrees) {
    const double a = 2 / (9 * degrees), root = 1 - a + std::sqrt(a) * random.normal();
    return std::max(1e-3, root * root * root);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        ab += a[k] * b[k];
        aa += a[k] * a[k];
        bb += b[k] * b[k];
    }
    return ab / std::sqrt(aa * bb);
}

/// One run of some sensors: whether any of them raises the alarm.
bool is_found(const LevelScatter& scatter, const PlannedChange& change, Random& random) {
    const double own = std::sqrt(1 - scatter.common), shared = std::sqrt(scatter.common);
    const auto series = [&] {
        std::vector<double> z(change.passages + 1); // the first one is the error of the mean
        const double session = random.normal(), within = std::sqrt(1 / (1 + scatter.between));
        z[0] = std::sqrt(scatter.levels.front().of_mean) * random.normal();
        double x = random.normal();
        for (std::size_t k = 1; k < z.size(); ++k) {
            if (k > 1)
                x = scatter.serial * x +
                    std::sqrt(1 - scatter.serial * scatter.serial) * random.normal();
            z[k] = within * (x + std::sqrt(scatter.between) * session);
        }
        return z;
    };
    const auto common = series();
    const double share =
        shares_of(std::vector<bool>(scatter.features, true), change.sensors).front();
    for (std::size_t s = 0; s < change.sensors; ++s) {
        const auto mine = series();
        const ExpectedFeature& level = scatter.levels[s % scatter.levels.size()];
        const double delta = std::log(change.ratio) / std::sqrt(level.variance);
        // the true deviation is known as well as the degrees of freedom say
        const double unit = std::sqrt(variance_factor(random, level.degrees));
        std::vector<double> z;
        for (std::size_t k = 1; k < mine.size(); ++k)
            z.push_back(delta +
                        (own * (mine[k] - mine[0]) + shared * (common[k] - common[0])) / unit);
        std::vector<double> each;
        for (const double one : z)
            each.push_back(p_of_deviation(one / std::sqrt(1 + level.of_mean), level.degrees));
        // what is not judged here, the other features, keeps its part of the false alarms
        const auto tests =
            tests_of_run(z, each, level, scatter.serial, scatter.between, false, share);
        if (std::ranges::any_of(tests, [&](const TestOfRun& test) {
                return test.p <= change.false_alarms * test.share;
            }))
            return true;
    }
    return false;
}

} // namespace

LevelScatter level_scatter(const std::vector<SensorBaseline>& baselines) {
    LevelScatter scatter;
    std::vector<std::vector<double>> residuals;
    for (const SensorBaseline& b : baselines) {
        if (!b.impossible_because.empty()) continue;
        const auto expected = b.features.typical();
        if (expected.empty() || !expected.front().is_known()) continue;
        scatter.levels.push_back(expected.front());
        scatter.features =
            static_cast<std::size_t>(std::ranges::count_if(expected, &ExpectedFeature::is_known));
        scatter.serial = b.features.serial();
        scatter.between = b.features.between();
        residuals.push_back(b.features.residuals(0));
    }
    require(!scatter.levels.empty(),
            "--plan: expected a baseline of at least four passages of a sensor");
    double sum = 0, pairs = 0;
    for (std::size_t i = 0; i < residuals.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (residuals[i].size() == residuals[j].size())
                if (const double r = correlation(residuals[i], residuals[j]); std::isfinite(r))
                    sum += r, ++pairs;
    if (pairs > 0) scatter.common = std::clamp(sum / pairs, 0.0, 1.0);
    return scatter;
}

double power_of(const LevelScatter& scatter, const PlannedChange& change, std::size_t draws,
                std::uint64_t seed) {
    std::size_t found = 0;
    for (std::size_t k = 0; k < draws; ++k) {
        Random random(seed, k);
        found += is_found(scatter, change, random);
    }
    return static_cast<double>(found) / static_cast<double>(draws);
}

} // namespace bris
