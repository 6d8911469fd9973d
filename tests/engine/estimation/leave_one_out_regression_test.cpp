#include "engine/errors.hpp"
#include "engine/estimation/leave_one_out_regression.hpp"
#include "engine/estimation/low_discrepancy.hpp"
#include "engine/estimation/student_t.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

Matrix normal_matrix(Eigen::Index rows, Eigen::Index columns, Random& random) {
    Matrix m(rows, columns);
    for (Eigen::Index c = 0; c < columns; ++c)
        for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = random.normal();
    return m;
}

Matrix without_row(const Matrix& m, Eigen::Index row) {
    Matrix rest(m.rows() - 1, m.cols());
    rest << m.topRows(row), m.bottomRows(m.rows() - row - 1);
    return rest;
}

// Ridge regression with an intercept by the normal equations: the prediction at `at`.
Vector ridge(const Matrix& x, const Matrix& y, double penalty, const Vector& at) {
    const Vector mx = x.colwise().mean().transpose(), my = y.colwise().mean().transpose();
    const Matrix cx = x.rowwise() - mx.transpose(), cy = y.rowwise() - my.transpose();
    const Matrix b = (cx.transpose() * cx + penalty * Matrix::Identity(x.cols(), x.cols()))
                         .ldlt()
                         .solve(cx.transpose() * cy);
    return my + b.transpose() * (at - mx);
}

// Features that follow three hidden causes, and targets of four groups: two that depend on the
// causes, one with much noise, one of pure noise.
struct Example {
    Matrix features, targets;
    Vector weights;
    std::vector<TargetGroup> groups{{0, 3}, {3, 2}, {5, 2}, {7, 2}};
    explicit Example(Eigen::Index samples, std::uint64_t seed) {
        Random random(seed, 1);
        const Matrix causes = normal_matrix(samples, 3, random);
        features = causes * normal_matrix(3, 6, random) + 0.3 * normal_matrix(samples, 6, random);
        features.col(2) *= 1e5; // features have units of their own
        features.col(4).array() += 300;
        targets.resize(samples, 9);
        targets << causes * normal_matrix(3, 5, random) + 0.2 * normal_matrix(samples, 5, random),
            causes * normal_matrix(3, 2, random) + 5 * normal_matrix(samples, 2, random),
            normal_matrix(samples, 2, random);
        targets.col(1) *= 1e6;
        weights = Vector::Constant(6, 1 / std::sqrt(3.0));
    }
};

} // namespace

TEST_SUITE("estimation/leave_one_out_regression") {
    TEST_CASE("residuals in closed form are those of regressions that each leave one sample out") {
        const Example e(30, 5);
        const LeaveOneOutRegression regression(e.features, e.weights, e.targets, e.groups);
        // the scales of the features are those of all samples
        Matrix scaled = e.features.rowwise() - e.features.colwise().mean().eval();
        for (Eigen::Index k = 0; k < scaled.cols(); ++k)
            scaled.col(k) *= e.weights[k] / std::sqrt(scaled.col(k).squaredNorm() / 29);
        for (std::size_t g = 0; g < e.groups.size(); ++g) {
            const auto [first, count] = e.groups[g];
            const double strength = regression.strengths()[g];
            const double penalty = std::isfinite(strength) ? 30 * strength / 10 : 1e30;
            for (Eigen::Index i = 0; i < 30; ++i) {
                const Vector predicted = ridge(without_row(scaled, i),
                                               without_row(e.targets.middleCols(first, count), i),
                                               penalty, scaled.row(i).transpose());
                for (Eigen::Index t = 0; t < count; ++t)
                    CHECK(regression.residuals()(i, first + t) ==
                          about(e.targets(i, first + t) - predicted[t]).epsilon(1e-8));
            }
        }
    }

    TEST_CASE("a prediction is the ridge regression of all samples, also for other units") {
        const Example e(30, 6);
        const LeaveOneOutRegression regression(e.features, e.weights, e.targets, e.groups);
        const Vector at = e.features.row(3).transpose() + 0.1 * e.features.row(4).transpose();
        const Vector mean = regression.predict(at).mean;
        Matrix scaled = e.features.rowwise() - e.features.colwise().mean().eval();
        Vector x = at - e.features.colwise().mean().transpose();
        for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
            const double scale = e.weights[k] / std::sqrt(scaled.col(k).squaredNorm() / 29);
            scaled.col(k) *= scale;
            x[k] *= scale;
        }
        const Vector expected =
            ridge(scaled, e.targets.leftCols(3), 30 * regression.strengths()[0] / 10, x);
        for (Eigen::Index t = 0; t < 3; ++t) CHECK(mean[t] == about(expected[t]).epsilon(1e-9));

        Matrix rescaled = e.features; // as if measured in other units and from another zero
        rescaled.col(0) = 1e-3 * rescaled.col(0).array() + 7;
        Vector other = at;
        other[0] = 1e-3 * other[0] + 7;
        const LeaveOneOutRegression again(rescaled, e.weights, e.targets, e.groups);
        for (Eigen::Index t = 0; t < 9; ++t)
            CHECK(again.predict(other).mean[t] == about(mean[t]).epsilon(1e-7));
    }

    TEST_CASE("with many samples the prediction approaches the posterior of a linear-Gaussian "
              "problem, and its band holds 90 % of the truths") {
        // y = a.u + e, x = B u + d with independent normal u, e, d: the posterior of y for a
        // measured x has mean a.B' (B B' + D)^-1 x and variance a.a + 0.25 - a.B' (..)^-1 B a
        Random random(11, 1);
        const Matrix b = normal_matrix(5, 3, random);
        const Vector a = normal_matrix(3, 1, random);
        const auto draw = [&](Eigen::Index n, Matrix& x, Matrix& y) {
            const Matrix u = normal_matrix(n, 3, random);
            x = u * b.transpose() + normal_matrix(n, 5, random);
            y = u * a + 0.5 * normal_matrix(n, 1, random);
        };
        Matrix x, y, new_x, new_y;
        draw(4000, x, y);
        draw(2000, new_x, new_y);
        const LeaveOneOutRegression regression(x, Vector::Constant(5, 1 / std::sqrt(5.0)), y,
                                               {{0, 1}});
        const Matrix gain = (a.transpose() * b.transpose()) *
                            (b * b.transpose() + Matrix::Identity(5, 5)).inverse();
        const double variance = a.squaredNorm() + 0.25 - (gain * b * a)(0, 0);
        const double t = student_t_quantile(0.95, regression.freedom());
        double off = 0, inside = 0;
        for (Eigen::Index i = 0; i < 2000; ++i) {
            const auto p = regression.predict(new_x.row(i).transpose());
            off += std::pow(p.mean[0] - (gain * new_x.row(i).transpose())(0, 0), 2) / 2000;
            inside += std::abs(new_y(i, 0) - p.mean[0]) < t * p.deviation[0] ? 1.0 / 2000 : 0;
        }
        // estimated from 4 000 samples: 5 coefficients leave 5 / 4 000 of the variance, the
        // deviation scatters by 1 / sqrt(8 000), coverage of 2 000 by 0.007. The smallest strength
        // tried shrinks the mean a little; distances beyond 1 widen 5 % of the bands.
        CHECK(off < 4 * variance * 5 / 4000);
        CHECK(regression.predict(Vector::Zero(5)).deviation[0] ==
              about(std::sqrt(variance)).epsilon(0.04));
        CHECK(inside > 0.88);
        CHECK(inside < 0.925);
    }

    TEST_CASE("where no regression beats the mean, the mean is used") {
        const Example e(40, 3);
        const LeaveOneOutRegression regression(e.features, e.weights, e.targets, e.groups);
        CHECK(std::isfinite(regression.strengths()[0]));
        Random random(4, 4);
        const Matrix noise = normal_matrix(40, 1, random);
        Matrix unrelated(40, 1); // the residual of noise against the features: nothing to learn
        const Matrix x = e.features.rowwise() - e.features.colwise().mean().eval();
        unrelated = noise - x * x.colPivHouseholderQr().solve(noise);
        const LeaveOneOutRegression none(e.features, e.weights, unrelated, {{0, 1}});
        CHECK(std::isinf(none.strengths()[0]));
        CHECK(none.predict(e.features.row(0).transpose()).mean[0] ==
              about(unrelated.mean()).epsilon(1e-9));
    }

    TEST_CASE("far from all samples the band widens in proportion to the distance") {
        const Example e(40, 7);
        const LeaveOneOutRegression regression(e.features, e.weights, e.targets, e.groups);
        const Vector centre = e.features.colwise().mean().transpose();
        const Vector step = e.features.row(1).transpose() - centre;
        const auto near = regression.predict(centre), far = regression.predict(centre + 20 * step),
                   farther = regression.predict(centre + 40 * step);
        CHECK(near.distance < 1e-9);
        CHECK(far.distance > 3);
        CHECK(farther.distance == about(2 * far.distance).epsilon(1e-9));
        for (Eigen::Index t = 0; t < 9; ++t) {
            CHECK(far.deviation[t] > 3 * near.deviation[t]);
            CHECK(farther.deviation[t] > 1.99 * far.deviation[t]);
        }
    }

    TEST_CASE("sizes that do not fit are refused") {
        const Example e(10, 1);
        CHECK_THROWS_AS(LeaveOneOutRegression(e.features, e.weights, e.targets, {{0, 3}}),
                        InputError);
        CHECK_THROWS_AS(LeaveOneOutRegression(e.features, Vector::Ones(2), e.targets, e.groups),
                        InputError);
        const LeaveOneOutRegression regression(e.features, e.weights, e.targets, e.groups);
        CHECK_THROWS_AS(regression.predict(Vector::Ones(5)), InputError);
        CHECK_THROWS_AS(regression.predict(Vector::Constant(6, std::nan(""))), InputError);
        const Matrix few = e.features.topRows(3), few_targets = e.targets.topRows(3);
        CHECK_THROWS_AS(LeaveOneOutRegression(few, e.weights, few_targets, e.groups), InputError);
    }
}

TEST_SUITE("estimation/low_discrepancy") {
    TEST_CASE("the first 64 points fill the unit cube more evenly than random points") {
        // largest error of the share of points in boxes [0, a) x [0, b) x [0, c)
        const auto discrepancy = [](const auto& point) {
            double worst = 0;
            for (double a = 0.25; a <= 1; a += 0.25)
                for (double b = 0.25; b <= 1; b += 0.25)
                    for (double c = 0.25; c <= 1; c += 0.25) {
                        double inside = 0;
                        for (std::uint64_t k = 1; k <= 64; ++k) {
                            const auto u = point(k);
                            inside += u[0] < a && u[1] < b && u[2] < c ? 1.0 / 64 : 0;
                        }
                        worst = std::max(worst, std::abs(inside - a * b * c));
                    }
            return worst;
        };
        // a share of 64 random points scatters by up to 0.06; the largest of 64 by more
        CHECK(discrepancy([](std::uint64_t k) { return low_discrepancy_point(k, 3); }) < 0.05);
        for (std::uint64_t k = 1; k < 1000; ++k)
            for (const double x : low_discrepancy_point(k, 5)) CHECK((x >= 0 && x < 1));
        CHECK_THROWS_AS(low_discrepancy_point(1, 0), InputError);
    }
}
