#include "engine/estimation/parameter_estimate.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr Eigen::Index nodes_along = 21; // quadrature nodes along each axis
constexpr double reach = 5;              // half width of the grid in current standard deviations
constexpr double comes_in = 2.5; // factor of the likelihood's exponent from one pass to the next
constexpr int most_passes = 40;  // passes with the whole likelihood
constexpr double settled = 1e-3; // relative change of the deviations at which the passes end

} // namespace

ParameterEstimate::ParameterEstimate(const Gaussian& prior, const Matrix& members,
                                     std::size_t channels, double tempering,
                                     Eigen::Index excluded_members,
                                     SpecimenCorrelation specimen_correlation)
    : prior_(prior), posterior_(prior), tempering_(tempering),
      specimen_correlation_(specimen_correlation), middle_(members.colwise().mean()),
      channels_(channels) {
    const Eigen::Index n = members.rows();
    require(
        prior.mean.size() == 2 && members.cols() == 2,
        fmt::format(
            "ensemble: expected two parameters in the prior and in each member, found {} and {}",
            prior.mean.size(), members.cols()));
    require(n >= static_cast<Eigen::Index>(fewest_members),
            fmt::format("ensemble: expected at least {} members, found {}", fewest_members, n));
    terms_ = n + excluded_members >= 12 ? 6 : 3;
    design_.resize(n, terms_);
    for (Eigen::Index j = 0; j < n; ++j)
        design_.row(j) = terms_at(members(j, 0), members(j, 1)).transpose();
    const Matrix square = design_.transpose() * design_;
    information_ = square.inverse();
    require(information_.allFinite() && (information_ * square).isIdentity(1e-6),
            "ensemble: expected members with different parameters, found a singular regression");
}

Vector ParameterEstimate::terms_at(double a, double b) const {
    const double x = a - middle_[0], y = b - middle_[1];
    Vector terms(terms_);
    terms.head(3) << 1, x, y;
    if (terms_ == 6) terms.tail(3) << x * x, x * y, y * y;
    return terms;
}

Vector ParameterEstimate::residuals_of(const Vector& numbers) const {
    return numbers - design_ * (information_ * (design_.transpose() * numbers));
}

ParameterEstimate::Difference ParameterEstimate::difference_of(const Channel& channel,
                                                               std::size_t k) const {
    const Raw& now = channel.raw[k];
    const double correlation =
        channel.raw.size() < 2
            ? 0
            : std::clamp(channel.correlation / static_cast<double>(channel.raw.size() - 1), 0.0,
                         1.0);
    double lasting = 0;
    Vector difference = now.forecast;
    double measured = now.measured.value, noise = now.measured.noise * now.measured.noise;
    if (k > 0 && channel.raw[k - 1].residuals.norm() > 0) {
        lasting = correlation * now.residuals.norm() / channel.raw[k - 1].residuals.norm();
        difference -= lasting * channel.raw[k - 1].forecast;
        measured -= lasting * channel.raw[k - 1].measured.value;
        noise += std::pow(lasting * channel.raw[k - 1].measured.noise, 2);
    }
    const double freedom =
        // one degree of freedom for r
        static_cast<double>(design_.rows() - terms_) - (lasting > 0 ? 1 : 0);
    return {.coefficients = information_ * (design_.transpose() * difference),
            .difference = measured,
            .lasting = lasting,
            .freedom = freedom,
            .divergence = residuals_of(difference).squaredNorm() / freedom,
            .noise = noise};
}

ParameterEstimate::Observations ParameterEstimate::observations() const {
    Observations observations;
    std::vector<std::pair<std::size_t, ParameterMeasurement>> taken; // channel and measurement
    for (std::size_t c = 0; c < channels_.size(); ++c)
        for (std::size_t k = 0; k < channels_[c].raw.size(); ++k) {
            observations.differences.push_back(difference_of(channels_[c], k));
            taken.emplace_back(c, channels_[c].raw[k].measured);
        }
    if (std::ranges::none_of(taken, [](const auto& t) { return t.second.scatter > 0; }))
        return observations;
    const auto n = static_cast<Eigen::Index>(taken.size());
    Matrix process(n, n), differences = Matrix::Identity(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const auto& [channel, a] = taken[static_cast<std::size_t>(k)];
        if (k > 0)
            differences(k, k - 1) = -observations.differences[static_cast<std::size_t>(k)]
                                         .lasting; // 0 for the first of a channel
        for (Eigen::Index l = 0; l < n; ++l) {
            const auto& [other, b] = taken[static_cast<std::size_t>(l)];
            process(k, l) = a.scatter * b.scatter *
                            (channel == other ? 1 : specimen_correlation_.channels) *
                            std::exp(-std::abs(a.stage - b.stage) / specimen_correlation_.memory);
        }
    }
    observations.own = differences * process * differences.transpose();
    return observations;
}

void ParameterEstimate::observe(std::size_t channel, const Vector& forecast,
                                const ParameterMeasurement& measured) {
    require(forecast.size() == design_.rows(),
            fmt::format("forecast: expected one value for each of {} members, found {}",
                        design_.rows(), forecast.size()));
    Channel& c = channels_[channel];
    c.raw.push_back({forecast, residuals_of(forecast), measured});
    if (c.raw.size() > 1) {
        const Vector &before = c.raw[c.raw.size() - 2].residuals, &now = c.raw.back().residuals;
        const double size = before.norm() * now.norm();
        if (size > 0) c.correlation += before.dot(now) / size;
    }
    stale_ = true;
}

double ParameterEstimate::normalised_innovation_squared(std::size_t channel) const {
    if (channels_[channel].raw.empty()) return std::nan("");
    const Observations observations = this->observations();
    std::size_t last = 0; // one past the last measurement of the channel
    for (std::size_t c = 0; c <= channel; ++c) last += channels_[c].raw.size();
    const Difference& m = observations.differences[--last];
    const Vector here = terms_at(posterior_.mean[0], posterior_.mean[1]);
    const double spread =
                     (posterior_.root.transpose() * m.coefficients.segment(1, 2)).squaredNorm(),
                 own = observations.own.size() > 0
                           ? observations.own.diagonal()[static_cast<Eigen::Index>(last)]
                           : 0;
    const double variance =
        m.divergence * (1 + here.dot(information_ * here)) + m.noise + own + spread;
    return std::pow(m.difference - m.coefficients.dot(here), 2) / variance;
}

const Gaussian& ParameterEstimate::parameters() {
    if (!stale_) return posterior_;
    observations_ = observations(); // with the current estimate of the correlation
    posterior_ = integral();
    stale_ = false;
    return posterior_;
}

double ParameterEstimate::log_likelihood(const Vector& at) const {
    const Vector terms = terms_at(at[0], at[1]);
    const double leverage = terms.dot(information_ * terms);
    if (observations_.own.size() == 0) {
        double sum = 0;
        for (const Difference& m : observations_.differences) {
            const double residual = m.difference - m.coefficients.dot(terms),
                         variance = m.divergence * (1 + leverage) + m.noise;
            sum -=
                0.5 * (std::log(variance) +
                       (m.freedom + 1) * std::log1p(residual * residual / (m.freedom * variance)));
        }
        return tempering_ * sum;
    }
    Matrix covariance = observations_.own;
    Vector residual(observations_.own.rows());
    for (Eigen::Index k = 0; k < residual.size(); ++k) {
        const Difference& m = observations_.differences[static_cast<std::size_t>(k)];
        residual[k] = m.difference - m.coefficients.dot(terms);
        // Divergence that is correlated along the test shifts a member as a whole; the tempering
        // accounts for that. It does not make the slopes less certain: if the leverage were divided
        // by the tempering as well, parameters far from the members would appear unlikely for that
        // reason alone.
        covariance(k, k) +=
            m.divergence * m.freedom / std::max(1.0, m.freedom - 2) * (1 / tempering_ + leverage) +
            m.noise; // variance of Student's t
    }
    const Eigen::LLT<Matrix> root(covariance);
    return -0.5 * root.matrixL().solve(residual).squaredNorm() -
           Vector(root.matrixLLT().diagonal()).array().log().sum();
}

// Mean and covariance of the prior times the likelihood to the power of `share`; `posterior` must
// be a rough approximation of the result.
Gaussian ParameterEstimate::integral_around(const Gaussian& posterior, double share) const {
    constexpr Eigen::Index n = 2, nodes = nodes_along * nodes_along;
    const double spacing = 2 * reach / (nodes_along - 1);
    Matrix at(n, nodes); // in standard deviations of `posterior`
    Vector log(nodes);
    for (Eigen::Index k = 0; k < nodes; ++k) {
        at.col(k) << spacing * static_cast<double>(k % nodes_along) - reach,
            spacing * static_cast<double>(k / nodes_along) - reach;
        const Vector here = posterior.mean + posterior.root * at.col(k);
        log[k] = share * log_likelihood(here) - 0.5 * squared_distance(prior_, here);
    }
    Vector weight = (log.array() - log.maxCoeff()).exp();
    weight /= weight.sum();
    const Vector mean = at * weight;
    const Matrix residual = at.colwise() - mean;
    // not narrower than the spacing of the nodes can resolve
    const Matrix covariance = residual * weight.asDiagonal() * residual.transpose() +
                              std::pow(0.3 * spacing, 2) * Matrix::Identity(n, n);
    return {posterior.mean + posterior.root * mean,
            posterior.root * covariance * posterior.root.transpose()};
}

// The exponent of the likelihood grows from pass to pass while the nodes contract to the region of
// the posterior: a narrow ridge would fall between the nodes of a wide grid.
Gaussian ParameterEstimate::integral() const {
    Gaussian posterior = prior_;
    for (double share = 1e-5; share < 1; share *= comes_in)
        posterior = integral_around(posterior, share);
    for (int pass = 0; pass < most_passes; ++pass) {
        const Matrix before = posterior.root;
        posterior = integral_around(posterior, 1);
        if ((posterior.root - before).norm() < settled * before.norm()) break;
    }
    return posterior;
}

EnsembleRegression::EnsembleRegression(const Matrix& members)
    : middle_(members.colwise().mean()), design_(members.rows(), members.cols() + 1) {
    design_.col(0).setOnes();
    design_.rightCols(members.cols()) = members.rowwise() - middle_.transpose();
    information_ = (design_.transpose() * design_).inverse();
}

Vector EnsembleRegression::weights_at(const Vector& parameters) const {
    Vector here(design_.cols());
    here << 1, parameters - middle_;
    return design_ * (information_ * here);
}

Matrix EnsembleRegression::residual_projection() const {
    return Matrix::Identity(design_.rows(), design_.rows()) -
           design_ * (information_ * design_.transpose());
}

} // namespace bris
