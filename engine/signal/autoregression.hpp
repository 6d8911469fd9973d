#pragma once

#include "engine/random.hpp"
#include "engine/signal/spectrum.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// Autoregressive model of a series x: x_t - mean = sum_i a_i (x_(t-i) - mean) + e_t, with
/// independent innovations e_t.
struct ArModel {
    double mean = 0;
    std::vector<double> coefficients = {}; ///< a_1 ... a_p
    double variance = 0;                   ///< of the innovations
    std::size_t order() const { return coefficients.size(); }
};

/// Models of the orders 0 to `largest` by the equations of Yule and Walker (recursion of Levinson
/// and Durbin) with autocovariances divided by the number of samples. Runs are parts of one
/// process, with a common mean. The variance is that of the equations; R's ar() prints it times n /
/// (n - p - 1). Throws InputError unless there are more samples than the order, and if all are
/// equal.
std::vector<ArModel> yule_walker(Runs runs, std::size_t largest);
/// Models of the orders 0 to `largest` by the method of Burg (1975): forward and backward
/// prediction errors of all runs are minimised together. Throws InputError as yule_walker, and
/// unless a run is longer than the order.
std::vector<ArModel> burg(Runs runs, std::size_t largest);
enum class ArMethod { burg, yule_walker };
const std::vector<std::string>& texts_of(ArMethod);
/// The model of one order by least squares of the forward errors, with its mean. The variance is
/// the mean square of the residuals. Throws InputError if there are too few samples.
ArModel least_squares_ar(Runs runs, std::size_t order);

/// Criteria of Akaike (1974) and Schwarz (1978) of each order, n ln(variance) + 2 p and n
/// ln(variance) + p ln(n), up to a constant, and the orders at their minima.
struct OrderChoice {
    std::vector<double> aic, bic;
    std::size_t by_aic = 0, by_bic = 0;
};
enum class OrderCriterion { bic, aic };
const std::vector<std::string>& texts_of(OrderCriterion);
/// `models`: of the orders 0 ...; `samples`: from which they were estimated.
OrderChoice choose_order(const std::vector<ArModel>& models, std::size_t samples);

/// Residuals e_t of a series from its sample p on: with the model that made it, its innovations.
std::vector<double> residuals_of(const ArModel& model, std::span<const double> series);
/// Autocovariances at the lags 0 to `lags` of the process of a stationary model.
std::vector<double> autocovariances_of(const ArModel& model, std::size_t lags);
/// One-sided spectral density of the process at a frequency (Hz), per Hz; `rate`: Hz.
double density_of(const ArModel& model, double frequency, double rate);

/// Estimated autocorrelations of runs at the lags 0 to `lags`, with one mean; divided by the number
/// of samples. All 0 but the first where the series is constant.
std::vector<double> autocorrelations(Runs runs, std::size_t lags);
/// Factor on the variance of the mean of n successive values by their autocorrelations at the lags
/// 0 to n - 1: 1 + 2 sum_k (1 - k / n) rho_k; at least 0.
double variance_factor_of_mean(std::span<const double> autocorrelations, std::size_t n);

/// A series of the model with normally distributed innovations, from a generator of its own.
class ArSeries {
public:
    /// Starts in a state that `warm_up` samples have made stationary.
    ArSeries(ArModel model, std::uint64_t seed, std::uint64_t stream, std::size_t warm_up = 1000);
    double next();

private:
    ArModel model_;
    Random random_;
    double deviation_;
    std::vector<double> before_; // deviations from the mean, the latest first
};

} // namespace bris
