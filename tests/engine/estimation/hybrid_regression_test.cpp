#include "engine/errors.hpp"
#include "engine/estimation/hybrid_regression.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

// One feature x in [-1, 1], uniform, and targets 2 x and sin(4 x), with noise.
struct Example {
    Matrix features, targets;
    Vector weights = Vector::Ones(1);
    std::vector<TargetGroup> groups{{0, 1}, {1, 1}};
    explicit Example(Eigen::Index samples, std::uint64_t seed)
        : features(samples, 1), targets(samples, 2) {
        Random random(seed, 1);
        for (Eigen::Index k = 0; k < samples; ++k) {
            const double x = random.uniform(-1, 1);
            features(k, 0) = x;
            targets.row(k) << 2 * x + 0.1 * random.normal(),
                std::sin(4 * x) + 0.1 * random.normal();
        }
    }
    HybridRegression regression() const { return {features, weights, targets, groups}; }
};

Matrix without_row(const Matrix& m, Eigen::Index row) {
    Matrix rest(m.rows() - 1, m.cols());
    rest << m.topRows(row), m.bottomRows(m.rows() - row - 1);
    return rest;
}

} // namespace

TEST_SUITE("estimation/hybrid_regression") {
    TEST_CASE("tempered weights count as much as the number of equal weights asked for, and fall "
              "with the distance") {
        const Vector distances = (Vector(6) << 9, 1, 4, 1.5, 30, 2).finished();
        for (const double effective : {1.5, 3.0, 5.0}) {
            const Vector w = tempered_weights(distances, effective);
            CHECK(w.sum() == about(1).epsilon(1e-12));
            CHECK(1 / w.squaredNorm() == about(effective).epsilon(1e-6));
            for (const auto& [near, far] : {std::pair{1, 3}, {3, 5}, {5, 2}, {2, 0}, {0, 4}})
                CHECK(w[near] > w[far]);
        }
        CHECK(tempered_weights(Vector::Constant(4, 7), 2) == Vector::Constant(4, 0.25));
        CHECK_THROWS_AS(tempered_weights(distances, 7), InputError);
        CHECK_THROWS_AS(tempered_weights(distances, 0.5), InputError);
        CHECK_THROWS_AS(tempered_weights(Vector::Constant(4, std::nan("")), 2), InputError);
    }

    TEST_CASE("a linear target is left to the regression, a curved one to the weighted samples") {
        const Example e(80, 3);
        const HybridRegression hybrid = e.regression();
        CHECK(hybrid.shares()[0] < 0.1);
        CHECK(hybrid.shares()[1] > 0.8);
        const LeaveOneOutRegression linear(e.features, e.weights, e.targets, e.groups);
        CHECK(hybrid.residuals().col(0).norm() <= linear.residuals().col(0).norm());
        // sin(4 x) has a standard deviation of 0.7 about any line; eight of eighty samples cover
        // a fifth of [-1, 1], where sine bends by 0.08, and their noise is 0.1 / sqrt 8 + 0.1
        CHECK(hybrid.residuals().col(1).norm() < 0.4 * linear.residuals().col(1).norm());
    }

    TEST_CASE("residuals are those of predictions that each leave one sample out") {
        const Example e(60, 8);
        const HybridRegression hybrid = e.regression();
        // Two things are left out of the closed form: the scale of the features is that of all
        // samples, and shares and strengths were chosen with them.
        double difference = 0;
        for (Eigen::Index i = 0; i < 60; ++i) {
            const HybridRegression others(without_row(e.features, i), e.weights,
                                          without_row(e.targets, i), e.groups);
            const auto p = others.predict(e.features.row(i).transpose());
            for (Eigen::Index t = 0; t < 2; ++t)
                if (p.distance <= 1)
                    difference = std::max(difference, std::abs(e.targets(i, t) - p.mean[t] -
                                                               hybrid.residuals()(i, t)));
        }
        CHECK(difference < 0.05);
    }

    TEST_CASE("far from all samples the prediction is that of the nearest ones, and its deviation "
              "grows with the distance") {
        const Example e(80, 3);
        const HybridRegression hybrid = e.regression();
        const auto far = hybrid.predict(Vector::Constant(1, 20)),
                   near = hybrid.predict(Vector::Constant(1, 0.9));
        CHECK(far.distance > 5);
        CHECK(far.mean[0] < 4); // the regression alone: 40
        CHECK(far.deviation[0] > 5 * near.deviation[0]);
        const Vector w = hybrid.sample_weights(Vector::Constant(1, 20));
        CHECK(w.sum() == about(1).epsilon(1e-12));
        Eigen::Index heaviest = 0, rightmost = 0;
        w.maxCoeff(&heaviest);
        e.features.col(0).maxCoeff(&rightmost);
        CHECK(heaviest == rightmost);
    }

    TEST_CASE("nine of ten new samples lie in the 90 % bands") {
        const HybridRegression hybrid = Example(80, 3).regression();
        const Example truths(400, 4);
        double inside = 0;
        for (Eigen::Index k = 0; k < 400; ++k) {
            const auto p = hybrid.predict(truths.features.row(k).transpose());
            for (Eigen::Index t = 0; t < 2; ++t)
                inside +=
                    std::abs(truths.targets(k, t) - p.mean[t]) < 1.66 * p.deviation[t] ? 1 : 0;
        }
        // binomial deviation 0.011; that of the deviations, from 80 samples, 8 %: 0.025
        CHECK(inside / 800 == about(0.9).epsilon(0.07));
    }
}
