#include "scenarios/ensemble/layouts.hpp"

#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/ensemble/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bris {

namespace {

/// Distance (m) up to which rocks count as near, about that of the centres of touching rocks: 1.5
/// times the median of the distances to the nearest rock.
double reach_of_neighbours(const std::vector<RockPose>& rocks) {
    std::vector<double> nearest;
    for (const RockPose& a : rocks) {
        double least = std::numeric_limits<double>::infinity();
        for (const RockPose& b : rocks)
            if (&a != &b) least = std::min(least, (a.position - b.position).norm());
        nearest.push_back(least);
    }
    std::ranges::nth_element(nearest,
                             nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2));
    return 1.5 * nearest[nearest.size() / 2];
}

enum class Role { host, near, other };

std::vector<Role> roles_of(const std::vector<RockPose>& rocks,
                           const std::vector<std::size_t>& hosts, double reach) {
    std::vector<Role> roles(rocks.size(), Role::other);
    for (std::size_t r = 0; r < rocks.size(); ++r)
        if (std::ranges::any_of(hosts, [&](std::size_t h) {
                return (rocks[r].position - rocks[h].position).norm() < reach;
            }))
            roles[r] = Role::near;
    for (const std::size_t h : hosts) roles[h] = Role::host;
    return roles;
}

double squared_shift(const ModelRun& run, const ModelRun& truth, std::size_t stage,
                     std::size_t rock) {
    return (run.displacement[stage][rock] - truth.displacement[stage][rock]).squaredNorm();
}
double squared_turn(const ModelRun& run, const ModelRun& truth, std::size_t stage,
                    std::size_t rock) {
    return attitude_error(exponential_map(run.rotation[stage][rock]),
                          exponential_map(truth.rotation[stage][rock]))
        .squaredNorm();
}

/// Sum over all stages, over the rocks that `counts` accepts.
template <class Squared, class Counts>
double error_of(const ModelRun& run, const ModelRun& truth, Squared&& squared, Counts&& counts) {
    double sum = 0;
    for (std::size_t k = 1; k < std::min(run.curves.size(), truth.curves.size()); ++k)
        for (std::size_t r = 0; r < truth.rocks.size(); ++r)
            if (counts(r)) sum += squared(run, truth, k, r);
    return sum;
}

LayoutResult try_one(const ModelRun& truth, const ModelRun& forecast, const RockScatter& scatter,
                     const LayoutTrial& trial, const std::vector<std::size_t>& hosts,
                     double interval, double reach) {
    const auto trajectories = recorded_trajectories(truth, hosts, interval, trial.position_noise,
                                                    trial.attitude_noise, trial.seed);
    const auto began = this_instant();
    const ModelRun analysis = compute_analysis(
        forecast, scatter, {hosts, trajectories, trial.position_noise, trial.attitude_noise});
    const double seconds = seconds_since(began) / static_cast<double>(forecast.curves.size() - 1);
    const std::vector<Role> roles = roles_of(truth.start, hosts, reach);
    const auto left = [&](const auto& squared, const auto& counts) {
        const double before = error_of(forecast, truth, squared, counts);
        return before > 0 ? std::sqrt(error_of(analysis, truth, squared, counts) / before) : 1;
    };
    const auto near = [&](std::size_t r) { return roles[r] == Role::near; };
    return {"",
            hosts.size(),
            interval,
            left(squared_shift, [&](std::size_t r) { return roles[r] == Role::host; }),
            left(squared_shift, near),
            left(squared_shift, [&](std::size_t r) { return roles[r] != Role::host; }),
            left(squared_turn, near),
            seconds};
}

LayoutResult mean_of(const std::vector<LayoutResult>& draws) {
    LayoutResult mean = draws.front();
    const auto over = [&](double LayoutResult::*value) {
        double sum = 0;
        for (const LayoutResult& d : draws) sum += std::log(d.*value);
        mean.*value = std::exp(sum / static_cast<double>(draws.size()));
    };
    for (const auto value :
         {&LayoutResult::hosts_error_ratio, &LayoutResult::near_error_ratio,
          &LayoutResult::others_error_ratio, &LayoutResult::near_rotation_error_ratio,
          &LayoutResult::seconds_per_stage})
        over(value);
    return mean;
}

std::vector<std::size_t> random_rocks(std::size_t rocks, std::size_t count, Random random) {
    std::vector<std::size_t> all(rocks);
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t k = 0; k < count; ++k)
        std::swap(
            all[k],
            all[k + static_cast<std::size_t>(random.uniform() * static_cast<double>(rocks - k))]);
    all.resize(count);
    return all;
}

} // namespace

std::vector<std::size_t> most_informative_rocks(const std::vector<RockPose>& rocks,
                                                const MotionScatter& scatter, double noise,
                                                std::size_t count) {
    const auto n = static_cast<Eigen::Index>(rocks.size());
    const std::vector<double>& deviation = scatter.deviation.back();
    Matrix covariance(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b)
            covariance(a, b) = deviation[static_cast<std::size_t>(a)] *
                               deviation[static_cast<std::size_t>(b)] *
                               scatter.correlation((rocks[static_cast<std::size_t>(a)].position -
                                                    rocks[static_cast<std::size_t>(b)].position)
                                                       .norm());
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < std::min(count, rocks.size()); ++k) {
        Eigen::Index best = 0;
        double most = -1;
        for (Eigen::Index r = 0; r < n; ++r) {
            const double gain =
                covariance.col(r).squaredNorm() / (covariance(r, r) + noise * noise);
            if (gain <= most || std::ranges::count(chosen, static_cast<std::size_t>(r)) > 0)
                continue;
            best = r;
            most = gain;
        }
        const Vector column = covariance.col(best);
        covariance -= column * column.transpose() / (column[best] + noise * noise);
        chosen.push_back(static_cast<std::size_t>(best));
    }
    return chosen;
}

std::vector<LayoutResult> try_layouts(const ModelRun& truth, const ModelRun& forecast,
                                      const RockScatter& scatter, const LayoutTrial& trial) {
    const double reach = reach_of_neighbours(truth.start);
    std::vector<LayoutResult> results;
    const auto add = [&](const char* layout, LayoutResult result) {
        result.layout = layout;
        results.push_back(std::move(result));
    };
    for (const double interval : trial.intervals) {
        const auto with = [&](const std::vector<std::size_t>& hosts) {
            return try_one(truth, forecast, scatter, trial, hosts, interval, reach);
        };
        if (truth.sensors > 0) add("placed", with(sensor_rocks(truth)));
        for (const std::size_t count : trial.sensors) {
            if (2 * count > truth.rocks.size()) continue;
            add("informed", with(most_informative_rocks(truth.start, scatter.displacement,
                                                        trial.position_noise, count)));
            std::vector<LayoutResult> draws;
            for (unsigned d = 0; d < trial.draws; ++d)
                draws.push_back(
                    with(random_rocks(truth.rocks.size(), count, Random(trial.seed, 4000 + d))));
            add("random", mean_of(draws));
        }
    }
    return results;
}

void write_layouts(const std::filesystem::path& path, const std::vector<LayoutResult>& results) {
    std::string csv =
        "layout,sensors,interval,sensor_rocks_error_ratio,near_error_ratio,others_error_ratio,near_"
        "rotation_left,seconds_per_stage\n";
    for (const LayoutResult& r : results) {
        csv += fmt::format("{},{},{:g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g}\n", r.layout, r.sensors,
                           r.interval, r.hosts_error_ratio, r.near_error_ratio,
                           r.others_error_ratio, r.near_rotation_error_ratio, r.seconds_per_stage);
    }
    write_whole(path, csv);
}

} // namespace bris
