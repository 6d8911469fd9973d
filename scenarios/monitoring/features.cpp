#include "scenarios/monitoring/features.hpp"

#include "engine/signal/fft.hpp"
#include "engine/signal/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t level = 0, level_total = 1, level_x = 2, level_y = 3, first_band = 4,
                      bands = 6, distance = first_band + bands, residuals = distance + 1,
                      first_reflection = residuals + 1, reflections = 3,
                      roll = first_reflection + reflections, rate_total = roll + 3,
                      all = rate_total + 1;
constexpr std::array<double, bands + 1> edges{2.5, 5, 10, 20, 40, 80, 160}; // Hz
constexpr double highest = 0.45;     // of the sampling rate: beyond it filters of the sensor decide
constexpr double least_share = 1e-9; // of the power, in a band

double half_logarithm(double square) { return square > 0 ? 0.5 * std::log(square) : unknown; }

/// Mean squares of three components about their means, over the samples of the ranges.
Vec3 mean_squares(const std::vector<Vec3>& values, const std::vector<SampleRange>& ranges,
                  const Mat3& turn) {
    Vec3 mean = Vec3::Zero(), squares = Vec3::Zero();
    double n = 0;
    for (const SampleRange& r : ranges)
        for (std::size_t k = r.begin; k < r.end; ++k, ++n) mean += values[k];
    mean /= n;
    for (const SampleRange& r : ranges)
        for (std::size_t k = r.begin; k < r.end; ++k)
            squares += (turn * (values[k] - mean)).cwiseAbs2();
    return squares / n;
}

/// The rotation from the axes of the rock to x and y of the attitude and the vertical by gravity.
Mat3 upright(const Recording& r, const std::vector<SampleRange>& ranges) {
    Vec3 mean = Vec3::Zero();
    for (const SampleRange& range : ranges)
        for (std::size_t k = range.begin; k < range.end; ++k) mean += r.force[k];
    const Quat attitude = r.info.attitude();
    const Vec3 up = attitude * mean.normalized();
    if (!(up.norm() > 0.5)) return attitude.toRotationMatrix();
    return (Quat::FromTwoVectors(up, Vec3::UnitZ()) * attitude).toRotationMatrix();
}

/// Powers of the three axes together in the bands, over their sum.
void add_bands(std::vector<double>& features, const Recording& r,
               const std::vector<SampleRange>& ranges, const std::vector<Vec3>& values) {
    const double rate = r.info.sampling_rate;
    const auto segment = fast_length_for(static_cast<std::size_t>(std::lround(1.28 * rate)));
    std::array<double, bands> power{};
    double sum = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<std::vector<double>> runs;
        for (const SampleRange& range : ranges) {
            if (range.end - range.begin < segment) continue;
            auto& run = runs.emplace_back();
            for (std::size_t k = range.begin; k < range.end; ++k) run.push_back(values[k][axis]);
        }
        if (runs.empty()) return;
        const Spectrum spectrum = welch(runs, rate, {.segment = segment});
        for (std::size_t b = 0; b < bands; ++b)
            if (edges[b + 1] <= highest * rate || (b > 0 && edges[b] < 0.75 * highest * rate)) {
                const double p =
                    band_power(spectrum, edges[b], std::min(edges[b + 1], highest * rate));
                power[b] += p;
                sum += p;
            }
    }
    if (!(sum > 0)) return;
    for (std::size_t b = 0; b < bands; ++b)
        if (power[b] > least_share * sum) features[first_band + b] = 0.5 * std::log(power[b] / sum);
}

} // namespace

const std::vector<Feature>& all_features() {
    using enum FeatureKind;
    static const std::vector<Feature> list{
        {"level", "vertical vibration", FeatureKind::level, false, 0, 1, false},
        {"level_total", "vibration of three axes", FeatureKind::level, false, 0, 1, false},
        {"level_x", "vibration along x", FeatureKind::level, true, 0, 1, false},
        {"level_y", "vibration along y", FeatureKind::level, true, 0, 1, false},
        {"band_2.5_5_Hz", "share of 2.5 to 5 Hz", spectrum, false, 1, 1, false},
        {"band_5_10_Hz", "share of 5 to 10 Hz", spectrum, false, 1, 1, false},
        {"band_10_20_Hz", "share of 10 to 20 Hz", spectrum, false, 1, 1, false},
        {"band_20_40_Hz", "share of 20 to 40 Hz", spectrum, false, 1, 1, false},
        {"band_40_80_Hz", "share of 40 to 80 Hz", spectrum, false, 1, 1, false},
        {"band_80_160_Hz", "share of 80 to 160 Hz", spectrum, false, 1, 1, false},
        {"model_distance", "distance to the baseline's model", spectrum, false, 2, 0, true},
        {"residual_level", "vibration that the model does not predict", spectrum, false, 0, 1,
         false},
        {"reflection_1", "first reflection coefficient", spectrum, false, 3, 0, false},
        {"reflection_2", "second reflection coefficient", spectrum, false, 3, 0, false},
        {"reflection_3", "third reflection coefficient", spectrum, false, 3, 0, false},
        {"roll_rate", "roll", motion, true, 0, 1, false},
        {"pitch_rate", "pitch", motion, true, 0, 1, false},
        {"yaw_rate", "yaw", motion, true, 0, 1, false},
        {"rate_total", "rotation about three axes", motion, false, 0, 1, false}};
    static_assert(all == 19);
    return list;
}

std::vector<double> features_of(const Recording& r, const Vibration& v,
                                const std::vector<SampleRange>& ranges) {
    std::vector<double> features(all, unknown);
    if (ranges.empty()) return features;
    features[level] = half_logarithm(moments_of(runs_in(v, ranges)).square);
    if (!r.force.empty()) {
        const Vec3 squares = mean_squares(r.force, ranges, upright(r, ranges));
        features[level_total] = half_logarithm(squares.sum());
        features[level_x] = half_logarithm(squares.x());
        features[level_y] = half_logarithm(squares.y());
    }
    add_bands(features, r, ranges, r.force.empty() ? r.rate : r.force);
    if (!r.rate.empty()) {
        const Vec3 squares = mean_squares(r.rate, ranges, r.info.attitude().toRotationMatrix());
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            features[roll + static_cast<std::size_t>(axis)] = half_logarithm(squares[axis]);
        features[rate_total] = half_logarithm(squares.sum());
    }
    return features;
}

void add_model_features(std::vector<double>& features, const ArModel& model, Runs runs,
                        double usual) {
    const std::size_t order = model.order();
    double squares = 0, n = 0;
    std::size_t samples = 0, longest = 0;
    for (const auto& run : runs) {
        samples += run.size();
        longest = std::max(longest, run.size());
        if (run.size() <= order) continue;
        for (const double e : residuals_of(model, run)) squares += e * e, ++n;
    }
    const std::size_t largest = std::max(order, reflections);
    if (!(n > 0) || !(squares > 0) || longest <= 2 * largest || samples <= 4 * largest) return;
    features[residuals] = half_logarithm(squares / n);
    const std::vector<ArModel> own = burg(runs, largest);
    // a model of p coefficients fits its own n samples better by p / n
    const double p = static_cast<double>(order), expected = p / std::max(p + 1, usual - p),
                 ratio = std::log(squares / n / own[order].variance) - p / n + expected;
    features[distance] = std::log(std::max(ratio, 0.1 * expected));
    for (std::size_t k = 0; k < reflections; ++k)
        features[first_reflection + k] =
            std::atanh(std::clamp(own[k + 1].coefficients.back(), -1 + 1e-12, 1 - 1e-12));
}

} // namespace bris
