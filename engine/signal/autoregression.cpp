#include "engine/signal/autoregression.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

namespace bris {

namespace {

double real(std::size_t n) { return static_cast<double>(n); }

std::size_t samples_of(Runs runs) {
    std::size_t n = 0;
    for (const auto& run : runs) n += run.size();
    return n;
}

double mean_of(Runs runs) {
    double sum = 0;
    for (const auto& run : runs) sum = std::accumulate(run.begin(), run.end(), sum);
    return sum / real(samples_of(runs));
}

void require_samples(Runs runs, std::size_t order) {
    std::size_t longest = 0;
    for (const auto& run : runs) longest = std::max(longest, run.size());
    require(longest > order,
            fmt::format("autoregression: expected a series longer than the order {}, found {} "
                        "samples",
                        order, longest));
}

[[noreturn]] void refuse_constant() {
    throw InputError("autoregression: expected a series that varies, found a constant one");
}

/// Sums of products of deviations from the mean at the lags 0 to `lags`, over the number of
/// samples.
std::vector<double> estimated_autocovariances(Runs runs, double mean, std::size_t lags) {
    std::vector<double> covariance(lags + 1, 0.0);
    for (const auto& run : runs)
        for (std::size_t lag = 0; lag <= lags; ++lag)
            for (std::size_t t = lag; t < run.size(); ++t)
                covariance[lag] += (run[t] - mean) * (run[t - lag] - mean);
    for (double& c : covariance) c /= real(samples_of(runs));
    return covariance;
}

/// The coefficients of the next order by its reflection coefficient (Levinson and Durbin).
std::vector<double> extended(const std::vector<double>& a, double reflection) {
    std::vector<double> next = a;
    for (std::size_t i = 0; i < a.size(); ++i) next[i] -= reflection * a[a.size() - 1 - i];
    next.push_back(reflection);
    return next;
}

/// Prediction errors of a run, forward and backward.
struct Errors {
    std::vector<double> forward, backward;
};

/// Reflection coefficient that minimises the errors of the next order.
double reflection_of(const std::vector<Errors>& errors, std::size_t order) {
    double products = 0, squares = 0;
    for (const Errors& e : errors)
        for (std::size_t t = order + 1; t < e.forward.size(); ++t) {
            const double f = e.forward[t], b = e.backward[t - 1];
            products += f * b;
            squares += f * f + b * b;
        }
    return squares > 0 ? 2 * products / squares : 0;
}

void advance(Errors& e, double reflection, std::size_t order) {
    for (std::size_t t = e.forward.size(); t-- > order + 1;) { // from the end: t - 1 is needed
        const double f = e.forward[t], b = e.backward[t - 1];
        e.forward[t] = f - reflection * b;
        e.backward[t] = b - reflection * f;
    }
}

} // namespace

std::vector<ArModel> yule_walker(Runs runs, std::size_t largest) {
    require_samples(runs, largest);
    const double mean = mean_of(runs);
    const std::vector<double> c = estimated_autocovariances(runs, mean, largest);
    if (!(c[0] > 0)) refuse_constant();
    std::vector<ArModel> models{{.mean = mean, .variance = c[0]}};
    for (std::size_t p = 0; p < largest; ++p) {
        const ArModel& last = models.back();
        double numerator = c[p + 1];
        for (std::size_t i = 0; i < p; ++i) numerator -= last.coefficients[i] * c[p - i];
        const double reflection = last.variance > 0 ? numerator / last.variance : 0;
        models.push_back({.mean = mean,
                          .coefficients = extended(last.coefficients, reflection),
                          .variance = last.variance * (1 - reflection * reflection)});
    }
    return models;
}

std::vector<ArModel> burg(Runs runs, std::size_t largest) {
    require_samples(runs, largest);
    const double mean = mean_of(runs);
    std::vector<Errors> errors;
    for (const auto& run : runs) {
        Errors& e = errors.emplace_back();
        for (const double x : run) e.forward.push_back(x - mean);
        e.backward = e.forward;
    }
    const double power = estimated_autocovariances(runs, mean, 0).front();
    if (!(power > 0)) refuse_constant();
    std::vector<ArModel> models{{.mean = mean, .variance = power}};
    for (std::size_t p = 0; p < largest; ++p) {
        const double reflection = reflection_of(errors, p);
        for (Errors& e : errors) advance(e, reflection, p);
        models.push_back({.mean = mean,
                          .coefficients = extended(models.back().coefficients, reflection),
                          .variance = models.back().variance * (1 - reflection * reflection)});
    }
    return models;
}

ArModel least_squares_ar(Runs runs, std::size_t order) {
    require_samples(runs, order);
    const double mean = mean_of(runs);
    std::size_t rows = 0;
    for (const auto& run : runs) rows += run.size() > order ? run.size() - order : 0;
    require(
        rows > order + 1,
        fmt::format("autoregression: expected more than {} equations, found {}", order + 1, rows));
    Eigen::MatrixXd x(rows, order + 1);
    Eigen::VectorXd y(rows);
    Eigen::Index row = 0;
    for (const auto& run : runs)
        for (std::size_t t = order; t < run.size(); ++t, ++row) {
            y[row] = run[t] - mean;
            x(row, 0) = 1;
            for (std::size_t i = 1; i <= order; ++i)
                x(row, static_cast<Eigen::Index>(i)) = run[t - i] - mean;
        }
    const Eigen::VectorXd solution = x.colPivHouseholderQr().solve(y);
    ArModel model{.variance = (y - x * solution).squaredNorm() / real(rows)};
    double sum = 0;
    for (std::size_t i = 1; i <= order; ++i) {
        model.coefficients.push_back(solution[static_cast<Eigen::Index>(i)]);
        sum += model.coefficients.back();
    }
    model.mean = mean + solution[0] / (1 - sum);
    return model;
}

const std::vector<std::string>& texts_of(ArMethod) {
    static const std::vector<std::string> texts{"burg", "yule_walker"};
    return texts;
}

const std::vector<std::string>& texts_of(OrderCriterion) {
    static const std::vector<std::string> texts{"bic", "aic"};
    return texts;
}

OrderChoice choose_order(const std::vector<ArModel>& models, std::size_t samples) {
    OrderChoice choice;
    for (std::size_t p = 0; p < models.size(); ++p) {
        const double fit = real(samples) * std::log(models[p].variance);
        choice.aic.push_back(fit + 2 * real(p));
        choice.bic.push_back(fit + real(p) * std::log(real(samples)));
    }
    const auto least = [](const std::vector<double>& values) {
        return static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
    };
    choice.by_aic = least(choice.aic);
    choice.by_bic = least(choice.bic);
    return choice;
}

std::vector<double> residuals_of(const ArModel& model, std::span<const double> series) {
    std::vector<double> residuals;
    const std::size_t p = model.order();
    if (series.size() > p) residuals.reserve(series.size() - p);
    for (std::size_t t = p; t < series.size(); ++t) {
        double e = series[t] - model.mean;
        for (std::size_t i = 0; i < p; ++i)
            e -= model.coefficients[i] * (series[t - 1 - i] - model.mean);
        residuals.push_back(e);
    }
    return residuals;
}

std::vector<double> autocovariances_of(const ArModel& model, std::size_t lags) {
    const std::size_t p = model.order();
    const auto size = static_cast<Eigen::Index>(p + 1);
    Eigen::MatrixXd equations = Eigen::MatrixXd::Identity(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    right[0] = model.variance;
    for (std::size_t k = 0; k <= p; ++k)
        for (std::size_t i = 1; i <= p; ++i)
            equations(static_cast<Eigen::Index>(k),
                      static_cast<Eigen::Index>(k > i ? k - i : i - k)) -=
                model.coefficients[i - 1];
    const Eigen::VectorXd solution = equations.colPivHouseholderQr().solve(right);
    std::vector<double> covariances(solution.begin(), solution.end());
    while (covariances.size() <= lags) {
        double next = 0;
        for (std::size_t i = 1; i <= p; ++i)
            next += model.coefficients[i - 1] * covariances[covariances.size() - i];
        covariances.push_back(next);
    }
    covariances.resize(lags + 1);
    return covariances;
}

double density_of(const ArModel& model, double frequency, double rate) {
    std::complex<double> a = 1;
    for (std::size_t i = 0; i < model.order(); ++i)
        a -= model.coefficients[i] * std::polar(1.0, -2 * pi * frequency / rate * real(i + 1));
    return 2 * model.variance / (rate * std::norm(a));
}

std::vector<double> autocorrelations(Runs runs, std::size_t lags) {
    std::vector<double> c = estimated_autocovariances(runs, mean_of(runs), lags);
    const double power = c[0];
    for (double& one : c) one = power > 0 ? one / power : 0;
    c[0] = 1;
    return c;
}

double variance_factor_of_mean(std::span<const double> rho, std::size_t n) {
    double factor = 1;
    for (std::size_t k = 1; k < n && k < rho.size(); ++k)
        factor += 2 * (1 - real(k) / real(n)) * rho[k];
    return std::max(0.0, factor);
}

ArSeries::ArSeries(ArModel model, std::uint64_t seed, std::uint64_t stream, std::size_t warm_up)
    : model_(std::move(model)), random_(seed, stream), deviation_(std::sqrt(model_.variance)),
      before_(model_.order(), 0.0) {
    for (std::size_t k = 0; k < warm_up; ++k) (void)next();
}

double ArSeries::next() {
    double x = deviation_ * random_.normal();
    for (std::size_t i = 0; i < before_.size(); ++i) x += model_.coefficients[i] * before_[i];
    for (std::size_t i = before_.size(); i-- > 1;) before_[i] = before_[i - 1];
    if (!before_.empty()) before_[0] = x;
    return model_.mean + x;
}

} // namespace bris
