#include "systems/fusion/parameter_estimate.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr int points = 25; // of the quadrature along each parameter
constexpr std::array specimens{-2.5, -2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5}; // in deviations

} // namespace

ParameterEstimate::ParameterEstimate(const Gaussian& prior, const Matrix& worlds, const std::vector<ParameterChannel>& channels, double trust)
    : prior_(prior), known_(prior), trust_(trust), middle_(worlds.colwise().mean()) {
    for (const ParameterChannel& c : channels) channels_.push_back({c, {}});
    const Eigen::Index n = worlds.rows();
    require(prior.mean.size() == 2 && worlds.cols() == 2, fmt::format("worlds: expected two parameters, found {} and {}", prior.mean.size(), worlds.cols()));
    require(n >= 6, fmt::format("worlds: expected at least 6 to learn from, found {}", n));
    terms_ = n >= 12 ? 6 : 3;
    design_.resize(n, terms_);
    for (Eigen::Index j = 0; j < n; ++j) design_.row(j) = terms_at(worlds(j, 0), worlds(j, 1)).transpose();
    const Matrix square = design_.transpose() * design_;
    information_ = square.inverse();
    require(information_.allFinite() && (information_ * square).isIdentity(1e-6), "worlds: expected different parameters, found them all alike");
}

Vector ParameterEstimate::terms_at(double a, double b) const {
    const double x = a - middle_[0], y = b - middle_[1];
    Vector terms(terms_);
    terms.head(3) << 1, x, y;
    if (terms_ == 6) terms.tail(3) << x * x, x * y, y * y;
    return terms;
}

Vector ParameterEstimate::left_of(const Vector& numbers) const { return numbers - design_ * (information_ * (design_.transpose() * numbers)); }

ParameterEstimate::Measurement ParameterEstimate::difference_of(const Channel& channel, std::size_t k) const {
    const Raw& now = channel.raw[k];
    const double correlation = channel.raw.size() < 2 ? 0 : std::clamp(channel.correlation / static_cast<double>(channel.raw.size() - 1), 0.0, 1.0);
    double lasting = 0;
    Vector difference = now.foretold;
    double measured = now.measured;
    if (k > 0 && channel.raw[k - 1].left.norm() > 0) {
        lasting = correlation * now.left.norm() / channel.raw[k - 1].left.norm();
        difference -= lasting * channel.raw[k - 1].foretold;
        measured -= lasting * channel.raw[k - 1].measured;
    }
    const double noise = channel.settings.noise;
    return {.coefficients = information_ * (design_.transpose() * difference),
            .difference = measured,
            .chaos = left_of(difference).squaredNorm() / (static_cast<double>(design_.rows() - terms_) - (lasting > 0 ? 1 : 0)), // one for r
            .noise = noise * noise * (1 + lasting * lasting),
            .own = (1 - lasting) * channel.settings.scatter};
}

void ParameterEstimate::see(std::size_t channel, const Vector& foretold, double measured) {
    require(foretold.size() == design_.rows(), fmt::format("foretold: expected one number of each of {} worlds, found {}", design_.rows(), foretold.size()));
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
    const Channel& c = channels_[channel];
    const Measurement m = difference_of(c, c.raw.size() - 1);
    const Vector here = terms_at(known_.mean[0], known_.mean[1]);
    const Matrix covariance = known_.covariance();
    double spread = 0;
    for (Eigen::Index p = 0; p < 2; ++p)
        for (Eigen::Index q = 0; q < 2; ++q) spread += m.coefficients[1 + p] * covariance(p, q) * m.coefficients[1 + q];
    const double variance = m.chaos * (1 + here.dot(information_ * here)) + m.noise + m.own * m.own + spread;
    return std::pow(m.difference - m.coefficients.dot(here), 2) / variance;
}

const Gaussian& ParameterEstimate::parameters() {
    if (!stale_) return known_;
    measurements_.clear(); // with the correlation as it is known now
    for (const Channel& one : channels_)
        for (std::size_t k = 0; k < one.raw.size(); ++k) measurements_.push_back(difference_of(one, k));
    known_ = integral();
    stale_ = false;
    return known_;
}

double ParameterEstimate::log_likelihood(const Vector& terms, double own) const {
    const auto freedom = static_cast<double>(design_.rows() - terms_);
    const double leverage = terms.dot(information_ * terms);
    double sum = 0;
    for (const Measurement& m : measurements_) {
        const double off = m.difference - m.coefficients.dot(terms) - own * m.own, variance = m.chaos * (1 + leverage) + m.noise;
        sum -= 0.5 * (std::log(variance) + (freedom + 1) * std::log1p(off * off / (freedom * variance)));
    }
    return sum;
}

// Mean and covariance of prior times likelihood to the power of `share`.
Gaussian ParameterEstimate::integral_over(const Box& box, double share) const {
    const bool scattered = std::ranges::any_of(channels_, [](const Channel& c) { return c.settings.scatter > 0; });
    const auto at = [&](std::size_t p, int k) { return box[p][0] + (box[p][1] - box[p][0]) * k / (points - 1); };
    struct Node { double log, a, b; };
    std::vector<Node> nodes;
    for (int i = 0; i < points; ++i)
        for (int j = 0; j < points; ++j) {
            const double a = at(0, i), b = at(1, j);
            const Vector terms = terms_at(a, b);
            const double u = (a - prior_.mean[0]) / prior_.root(0, 0), v = (b - prior_.mean[1] - prior_.root(1, 0) * u) / prior_.root(1, 1);
            for (const double own : specimens)
                if (scattered || own == 0) nodes.push_back({trust_ * share * log_likelihood(terms, own) - 0.5 * (u * u + v * v + own * own), a - box[0][0], b - box[1][0]});
        }
    const double largest = std::ranges::max(nodes, {}, &Node::log).log;
    double sum = 0, ma = 0, mb = 0, aa = 0, ab = 0, bb = 0;
    for (const auto& [log, a, b] : nodes) {
        const double w = std::exp(log - largest);
        sum += w;
        ma += w * a;
        mb += w * b;
        aa += w * a * a;
        ab += w * a * b;
        bb += w * b * b;
    }
    ma /= sum;
    mb /= sum;
    Vector mean(2);
    mean << box[0][0] + ma, box[1][0] + mb;
    // no finer than the nodes stand
    const auto least = [&](std::size_t p) { return std::pow(0.3 * (box[p][1] - box[p][0]) / (points - 1), 2); };
    Matrix covariance(2, 2);
    covariance << aa / sum - ma * ma + least(0), ab / sum - ma * mb, ab / sum - ma * mb, bb / sum - mb * mb + least(1);
    return {mean, covariance};
}

// The likelihood comes in by shares, and the box closes in on where the posterior is: a narrow ridge would fall between the
// nodes of a wide one.
Gaussian ParameterEstimate::integral() const {
    Box box;
    for (Eigen::Index p = 0; p < 2; ++p) {
        const double reach = 4 * prior_.root.row(p).norm();
        box[static_cast<std::size_t>(p)] = {prior_.mean[p] - reach, prior_.mean[p] + reach};
    }
    Gaussian known = prior_;
    for (const double share : {1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0, 1.0, 1.0}) {
        known = integral_over(box, share);
        for (std::size_t p = 0; p < 2; ++p) {
            const auto row = static_cast<Eigen::Index>(p);
            const double reach = 6 * known.root.row(row).norm();
            box[p] = {std::max(box[p][0], known.mean[row] - reach), std::min(box[p][1], known.mean[row] + reach)};
        }
    }
    return known;
}

WorldRegression::WorldRegression(const Matrix& worlds) : middle_(worlds.colwise().mean()), design_(worlds.rows(), worlds.cols() + 1) {
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
    return Matrix::Identity(design_.rows(), design_.rows()) - design_ * (information_ * design_.transpose());
}

} // namespace bris
