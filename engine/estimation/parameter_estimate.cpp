#include "engine/estimation/parameter_estimate.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr Eigen::Index nodes_along = 21; // of the quadrature, along each axis
constexpr double reach = 5;              // of it, in deviations of what is known so far
constexpr double comes_in = 2.5;         // the likelihood, by this factor from pass to pass
constexpr int most_passes = 40;          // with all of it, until deviations change by less than:
constexpr double settled = 1e-3;

} // namespace

ParameterEstimate::ParameterEstimate(const Gaussian& prior, const Matrix& worlds,
                                     std::size_t channels, double trust, Eigen::Index more_worlds,
                                     SpecimenLikeness likeness)
    : prior_(prior), known_(prior), trust_(trust), likeness_(likeness),
      middle_(worlds.colwise().mean()), channels_(channels) {
    const Eigen::Index n = worlds.rows();
    require(prior.mean.size() == 2 && worlds.cols() == 2,
            fmt::format("worlds: expected two parameters, found {} and {}", prior.mean.size(),
                        worlds.cols()));
    require(n >= static_cast<Eigen::Index>(fewest_worlds),
            fmt::format("worlds: expected at least {} to learn from, found {}", fewest_worlds, n));
    terms_ = n + more_worlds >= 12 ? 6 : 3;
    design_.resize(n, terms_);
    for (Eigen::Index j = 0; j < n; ++j)
        design_.row(j) = terms_at(worlds(j, 0), worlds(j, 1)).transpose();
    const Matrix square = design_.transpose() * design_;
    information_ = square.inverse();
    require(information_.allFinite() && (information_ * square).isIdentity(1e-6),
            "worlds: expected different parameters, found them all alike");
}

Vector ParameterEstimate::terms_at(double a, double b) const {
    const double x = a - middle_[0], y = b - middle_[1];
    Vector terms(terms_);
    terms.head(3) << 1, x, y;
    if (terms_ == 6) terms.tail(3) << x * x, x * y, y * y;
    return terms;
}

Vector ParameterEstimate::left_of(const Vector& numbers) const {
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
    Vector difference = now.foretold;
    double measured = now.measured.value, noise = now.measured.noise * now.measured.noise;
    if (k > 0 && channel.raw[k - 1].left.norm() > 0) {
        lasting = correlation * now.left.norm() / channel.raw[k - 1].left.norm();
        difference -= lasting * channel.raw[k - 1].foretold;
        measured -= lasting * channel.raw[k - 1].measured.value;
        noise += std::pow(lasting * channel.raw[k - 1].measured.noise, 2);
    }
    const double freedom =
        static_cast<double>(design_.rows() - terms_) - (lasting > 0 ? 1 : 0); // one for r
    return {.coefficients = information_ * (design_.transpose() * difference),
            .difference = measured,
            .lasting = lasting,
            .freedom = freedom,
            .chaos = left_of(difference).squaredNorm() / freedom,
            .noise = noise};
}

ParameterEstimate::Seen ParameterEstimate::seen() const {
    Seen seen;
    std::vector<std::pair<std::size_t, ParameterMeasurement>> taken; // channel, as measured
    for (std::size_t c = 0; c < channels_.size(); ++c)
        for (std::size_t k = 0; k < channels_[c].raw.size(); ++k) {
            seen.differences.push_back(difference_of(channels_[c], k));
            taken.emplace_back(c, channels_[c].raw[k].measured);
        }
    if (std::ranges::none_of(taken, [](const auto& t) { return t.second.scatter > 0; }))
        return seen;
    const auto n = static_cast<Eigen::Index>(taken.size());
    Matrix process(n, n), differences = Matrix::Identity(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const auto& [channel, a] = taken[static_cast<std::size_t>(k)];
        if (k > 0)
            differences(k, k - 1) = -seen.differences[static_cast<std::size_t>(k)]
                                         .lasting; // 0 for the first of a channel
        for (Eigen::Index l = 0; l < n; ++l) {
            const auto& [other, b] = taken[static_cast<std::size_t>(l)];
            process(k, l) = a.scatter * b.scatter * (channel == other ? 1 : likeness_.channels) *
                            std::exp(-std::abs(a.place - b.place) / likeness_.memory);
        }
    }
    seen.own = differences * process * differences.transpose();
    return seen;
}

void ParameterEstimate::see(std::size_t channel, const Vector& foretold,
                            const ParameterMeasurement& measured) {
    require(foretold.size() == design_.rows(),
            fmt::format("foretold: expected one number of each of {} worlds, found {}",
                        design_.rows(), foretold.size()));
    Channel& c = channels_[channel];
    c.raw.push_back({foretold, left_of(foretold), measured});
    if (c.raw.size() > 1) {
        const Vector &before = c.raw[c.raw.size() - 2].left, &now = c.raw.back().left;
        const double size = before.norm() * now.norm();
        if (size > 0) c.correlation += before.dot(now) / size;
    }
    stale_ = true;
}

double ParameterEstimate::surprise(std::size_t channel) const {
    const Seen seen = this->seen();
    std::size_t last = 0; // of that channel
    for (std::size_t c = 0; c <= channel; ++c) last += channels_[c].raw.size();
    const Difference& m = seen.differences[--last];
    const Vector here = terms_at(known_.mean[0], known_.mean[1]);
    const double spread = (known_.root.transpose() * m.coefficients.segment(1, 2)).squaredNorm(),
                 own =
                     seen.own.size() > 0 ? seen.own.diagonal()[static_cast<Eigen::Index>(last)] : 0;
    const double variance = m.chaos * (1 + here.dot(information_ * here)) + m.noise + own + spread;
    return std::pow(m.difference - m.coefficients.dot(here), 2) / variance;
}

const Gaussian& ParameterEstimate::parameters() {
    if (!stale_) return known_;
    seen_ = seen(); // with the correlation as it is known now
    known_ = integral();
    stale_ = false;
    return known_;
}

double ParameterEstimate::log_likelihood(const Vector& at) const {
    const Vector terms = terms_at(at[0], at[1]);
    const double leverage = terms.dot(information_ * terms);
    if (seen_.own.size() == 0) {
        double sum = 0;
        for (const Difference& m : seen_.differences) {
            const double off = m.difference - m.coefficients.dot(terms),
                         variance = m.chaos * (1 + leverage) + m.noise;
            sum -= 0.5 * (std::log(variance) +
                          (m.freedom + 1) * std::log1p(off * off / (m.freedom * variance)));
        }
        return trust_ * sum;
    }
    Matrix covariance = seen_.own;
    Vector off(seen_.own.rows());
    for (Eigen::Index k = 0; k < off.size(); ++k) {
        const Difference& m = seen_.differences[static_cast<std::size_t>(k)];
        off[k] = m.difference - m.coefficients.dot(terms);
        // chaos that lasts (trust) moves a world as a whole, and makes slopes no less sure: or far
        // parameters would seem unlikely for that alone
        covariance(k, k) +=
            m.chaos * m.freedom / std::max(1.0, m.freedom - 2) * (1 / trust_ + leverage) +
            m.noise; // the variance of Student's t
    }
    const Eigen::LLT<Matrix> root(covariance);
    return -0.5 * root.matrixL().solve(off).squaredNorm() -
           Vector(root.matrixLLT().diagonal()).array().log().sum();
}

// Mean and covariance of prior times likelihood to the power of `share`, about which `known` is
// roughly right.
Gaussian ParameterEstimate::integral_around(const Gaussian& known, double share) const {
    constexpr Eigen::Index n = 2, nodes = nodes_along * nodes_along;
    const double spacing = 2 * reach / (nodes_along - 1);
    Matrix at(n, nodes); // in deviations of what is known
    Vector log(nodes);
    for (Eigen::Index k = 0; k < nodes; ++k) {
        at.col(k) << spacing * static_cast<double>(k % nodes_along) - reach,
            spacing * static_cast<double>(k / nodes_along) - reach;
        const Vector here = known.mean + known.root * at.col(k);
        log[k] = share * log_likelihood(here) - 0.5 * squared_distance(prior_, here);
    }
    Vector weight = (log.array() - log.maxCoeff()).exp();
    weight /= weight.sum();
    const Vector mean = at * weight;
    const Matrix off = at.colwise() - mean;
    // no finer than the nodes stand
    const Matrix covariance = off * weight.asDiagonal() * off.transpose() +
                              std::pow(0.3 * spacing, 2) * Matrix::Identity(n, n);
    return {known.mean + known.root * mean, known.root * covariance * known.root.transpose()};
}

// The likelihood comes in by shares, and the nodes close in on where the posterior is: a narrow
// ridge would fall between those of a wide grid.
Gaussian ParameterEstimate::integral() const {
    Gaussian known = prior_;
    for (double share = 1e-5; share < 1; share *= comes_in) known = integral_around(known, share);
    for (int pass = 0; pass < most_passes; ++pass) {
        const Matrix before = known.root;
        known = integral_around(known, 1);
        if ((known.root - before).norm() < settled * before.norm()) break;
    }
    return known;
}

WorldRegression::WorldRegression(const Matrix& worlds)
    : middle_(worlds.colwise().mean()), design_(worlds.rows(), worlds.cols() + 1) {
    design_.col(0).setOnes();
    design_.rightCols(worlds.cols()) = worlds.rowwise() - middle_.transpose();
    information_ = (design_.transpose() * design_).inverse();
}

Vector WorldRegression::weights_at(const Vector& parameters) const {
    Vector here(design_.cols());
    here << 1, parameters - middle_;
    return design_ * (information_ * here);
}

Matrix WorldRegression::leaves() const {
    return Matrix::Identity(design_.rows(), design_.rows()) -
           design_ * (information_ * design_.transpose());
}

} // namespace bris
