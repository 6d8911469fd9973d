#include "scenarios/ensemble/fused_stress.hpp"

#include "scenarios/ensemble/specimen_correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numeric>
#include <vector>

namespace bris {

namespace {

constexpr double band = 1.960;         // standard deviations: 95 %
constexpr double limit = 2.576;        // 99 %
constexpr std::size_t remembered = 20; // records by which the band is widened
constexpr unsigned times_running = 3;  // outside the band

/// ln q of the members at one stage.
struct StageForecast {
    double model = 0;      ///< of their regression at the parameter estimate
    double parameters = 0; ///< variance by the uncertain parameters
    double slips = 0;      ///< variance of a run about the regression
    Vector residuals;
    bool usable = false; ///< all members carry a stress
};

std::vector<StageForecast> forecasts(const Ensemble& members, const Gaussian& estimate,
                                     std::size_t stage) {
    const EnsembleRegression regression(logarithms_of(members.parameters));
    const Matrix projection = regression.residual_projection();
    const Vector weights = regression.weights_at(estimate.mean);
    const auto n = static_cast<Eigen::Index>(members.runs.size());
    std::vector<StageForecast> all(stage + 1);
    for (std::size_t k = 1; k <= stage; ++k) {
        const Vector q = Vector::NullaryExpr(n, [&](Eigen::Index j) {
            return members.runs[static_cast<std::size_t>(j)].curves[quantity::deviatoric_stress][k];
        });
        StageForecast& f = all[k];
        f.usable = q.minCoeff() > no_stress;
        if (!f.usable) continue;
        const Vector ln_q = q.array().log();
        f.model = weights.dot(ln_q);
        for (Eigen::Index i = 0; i < estimate.root.cols(); ++i)
            f.parameters += std::pow(
                regression.weights_at(estimate.mean + estimate.root.col(i)).dot(ln_q) - f.model, 2);
        f.residuals = projection * ln_q;
        f.slips = f.residuals.squaredNorm() / std::max(1.0, static_cast<double>(n - 3)) *
                  (1 + weights.squaredNorm());
    }
    return all;
}

/// Mean correlation of the residuals at successive stages, as ParameterEstimate has it.
double correlation_of(const std::vector<StageForecast>& all) {
    double sum = 0, count = 0;
    for (std::size_t k = 2; k < all.size(); ++k) {
        if (!all[k].usable || !all[k - 1].usable) continue;
        const double size = all[k].residuals.norm() * all[k - 1].residuals.norm();
        if (size > 0) sum += all[k].residuals.dot(all[k - 1].residuals) / size;
        ++count;
    }
    return count > 0 ? std::clamp(sum / count, 0.0, 1.0) : 0;
}

/// Measured q (Pa) by stage; NaN: not measured.
std::vector<double> measured_by_stage(const Ensemble& members, const MeasuredCurves& measured,
                                      std::size_t stage) {
    std::vector<double> all(stage + 1, std::nan(""));
    const auto &strain = measured[quantity::axial_strain],
               &q = measured[quantity::deviatoric_stress];
    for (std::size_t k = 0; k < measured.size(); ++k) {
        const auto at = stage_of_sample(members.runs.front(), strain[k]);
        if (at && *at <= stage && std::isfinite(q[k])) all[*at] = q[k];
    }
    return all;
}

double mean_stress(const Ensemble& members, std::size_t stage) {
    double sum = 0;
    for (const ModelRun& run : members.runs) sum += run.curves[quantity::deviatoric_stress][stage];
    return sum / static_cast<double>(members.runs.size());
}

/// Deviation of ln q of the specimen: of its packing, and of its slips.
class Deviation {
public:
    Deviation(double correlation, double scatter) : correlation_(correlation), scatter_(scatter) {}

    void advance(const StageForecast& now, double strain) {
        // parameters that are uncertain shift all stages alike
        const bool first = strain_ == 0;
        const double stays =
            first ? 0 : std::exp(-std::log(strain / strain_) / specimen_correlation.memory);
        const double lasts =
            first || slips_ == 0 ? 0 : correlation_ * std::sqrt(now.slips / slips_);
        const double fresh = first || slips_ == 0 ? 1 : 1 - correlation_ * correlation_;
        mean_ = {stays * mean_[0], lasts * mean_[1]};
        packing_ = stays * stays * packing_ + (1 - stays * stays) * scatter_ * scatter_ +
                   (first ? now.parameters : 0);
        own_ = lasts * lasts * own_ + fresh * now.slips;
        both_ *= stays * lasts;
        strain_ = strain;
        slips_ = now.slips;
    }
    double mean() const { return mean_[0] + mean_[1]; }
    double variance() const { return packing_ + 2 * both_ + own_; }
    void update(double found, double noise) {
        const double innovation = found - mean(), total = variance() + noise * noise;
        const double a = packing_ + both_, b = own_ + both_; // covariances with the sum
        mean_[0] += a / total * innovation;
        mean_[1] += b / total * innovation;
        packing_ -= a * a / total;
        own_ -= b * b / total;
        both_ -= a * b / total;
    }

private:
    double correlation_, scatter_;
    double strain_ = 0, slips_ = 0; // of the last stage
    std::array<double, 2> mean_{};
    double packing_ = 0, own_ = 0, both_ = 0; // variances and covariance
};

/// Normalised innovations squared of the last records.
class Surprises {
public:
    void add(double squared) {
        squares_.push_back(squared);
        if (squares_.size() > remembered) squares_.pop_front();
    }
    /// Factor by which variances were too small; at least 1.
    double factor() const {
        const double sum = std::accumulate(squares_.begin(), squares_.end(), 0.0);
        return squares_.empty() ? 1 : std::max(1.0, sum / static_cast<double>(squares_.size()));
    }

private:
    std::deque<double> squares_;
};

/// Whether a record agrees with a model that differs from it by `difference` in ln q.
void judge(FusedStress& result, double difference, double scatter, unsigned outside) {
    const bool is_other = std::abs(difference) > limit * scatter;
    result.agreement = is_other || outside >= times_running ? FusedStress::Agreement::disagrees
                                                            : FusedStress::Agreement::agrees;
    result.reason =
        fmt::format("the measured q is {:.3g} times that of the model", std::exp(difference));
    if (is_other)
        result.reason += fmt::format(", where 99 % of such specimens have {:.2g} to {:.2g} times",
                                     std::exp(-limit * scatter), std::exp(limit * scatter));
    else if (outside >= times_running)
        result.reason +=
            fmt::format("; it was outside the band of fused in {} successive stages", outside);
}

/// A record of a stage at which the model or the specimen has no stress to speak of.
void judge_without_stress(FusedStress& result, double measured, double model) {
    if (std::isnan(measured)) return;
    result.measured = measured;
    result.reason = fmt::format("q is {:.3g} kPa in the test and {:.3g} kPa in the model",
                                1e-3 * measured, 1e-3 * model);
    if (std::max(measured, model) > 10 * no_stress)
        result.agreement = FusedStress::Agreement::disagrees;
}

} // namespace

FusedStress fused_stress(const Ensemble& members, const Gaussian& estimate,
                         const MeasuredCurves& measured, const Learning& settings,
                         std::size_t stage) {
    const auto all = forecasts(members, estimate, stage);
    const auto q = measured_by_stage(members, measured, stage);
    const auto& strains = members.runs.front().curves[quantity::axial_strain];
    Deviation deviation(correlation_of(all), settings.specimen_scatter);
    Surprises surprises;
    FusedStress result;
    unsigned outside = 0;
    bool has_records = false;
    const double noise = settings.force_noise * settings.force_noise;
    for (std::size_t k = 1; k <= stage; ++k) {
        if (!all[k].usable) continue;
        deviation.advance(all[k], strains[k]);
        const double total = deviation.variance() + noise,
                     half = band * std::sqrt(total * surprises.factor());
        if (k == stage) {
            result.model = std::exp(all[k].model);
            if (has_records) {
                result.fused = std::exp(all[k].model + deviation.mean());
                result.half_width = result.fused * std::expm1(half);
            }
        }
        if (!(q[k] > no_stress)) continue;
        const double difference = std::log(q[k]) - all[k].model,
                     innovation = difference - deviation.mean();
        outside = has_records && std::abs(innovation) > half ? outside + 1 : 0;
        if (k == stage) {
            result.measured = q[k];
            judge(result, difference,
                  std::sqrt(std::pow(settings.specimen_scatter, 2) + all[k].parameters +
                            all[k].slips + noise),
                  outside);
        }
        if (has_records) surprises.add(innovation * innovation / total);
        deviation.update(difference, settings.force_noise);
        has_records = true;
    }
    if (!all[stage].usable || !(q[stage] > no_stress))
        judge_without_stress(result, q[stage], mean_stress(members, stage));
    return result;
}

} // namespace bris
