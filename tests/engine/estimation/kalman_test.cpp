#include "engine/estimation/constant_velocity.hpp"
#include "engine/estimation/printed_filter.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"
#include "tests/engine/estimation/chi_squared_band.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace bris;

namespace {

/// Transition of position and velocity for an acceleration that is constant within T (s), with the
/// variance s2, (m/s2)2, and independent from step to step (Kalata 1984).
Transition constant_acceleration(int axes, double T, double s2) {
    const double T2 = T * T;
    return {
        detail::for_each_axis(axes, 1, T, 0, 1),
        detail::for_each_axis(axes, s2 * T2 * T2 / 4, s2 * T2 * T / 2, s2 * T2 * T / 2, s2 * T2)};
}

Matrix scalar(double x) { return Matrix::Constant(1, 1, x); }
Vector numbers(std::initializer_list<double> list) {
    Vector v(static_cast<Eigen::Index>(list.size()));
    std::copy(list.begin(), list.end(), v.begin());
    return v;
}

/// Observation matrix of the first of n variables.
Matrix sees_first(Eigen::Index n) {
    Matrix H = Matrix::Zero(1, n);
    H(0, 0) = 1;
    return H;
}

Vector draw(Random& random, const Matrix& covariance) {
    Vector z(covariance.rows());
    for (double& x : z) x = random.normal();
    return root_of<double>(covariance) * z;
}

struct SteadyState {
    double position_gain, velocity_gain, predicted_variance;
};

SteadyState run_until_steady(const Transition& t) {
    Gaussian x(Vector::Zero(2), 100 * Matrix::Identity(2, 2));
    SteadyState s{};
    for (int k = 0; k < 2000; ++k) {
        x = predict(x, t);
        s.predicted_variance = x.covariance()(0, 0);
        const auto c = update<double>(x, Vector::Zero(1), sees_first(2), scalar(1));
        s.position_gain = c.gain(0, 0);
        s.velocity_gain = c.gain(1, 0);
        x = c.estimate;
    }
    return s;
}

/// One step of a filter: the transition that led to it, and the estimates before and after its
/// measurement.
struct FilterStep {
    Transition transition;
    Gaussian predicted, corrected;
};

/// Motion of a body under white-noise acceleration, with measured positions.
struct Walk {
    Transition t = white_acceleration(1, 0.1, 0.5);
    double variance = 0.04;
    Gaussian before{Vector::Zero(2), numbers({1, 4}).asDiagonal().toDenseMatrix()};
    std::vector<Vector> truth;
    std::vector<double> y;
    Walk(std::uint64_t seed, int steps) {
        Random random(seed, 0);
        Vector x = draw(random, before.covariance());
        for (int k = 0; k < steps; ++k) {
            x = t.F * x + draw(random, t.Q);
            truth.push_back(x);
            y.push_back(x[0] + std::sqrt(variance) * random.normal());
        }
    }
    struct Filtered {
        std::vector<FilterStep> steps;
        std::vector<double> distances;
        double log_likelihood = 0;
    };
    Filtered filtered(double noise_factor) const {
        Filtered f;
        Gaussian x = before;
        const Transition assumed{t.F, noise_factor * t.Q};
        for (const double measured : y) {
            FilterStep step{assumed, predict(x, assumed), {}};
            const auto c = update<double>(step.predicted, numbers({measured}), sees_first(2),
                                          scalar(variance));
            x = step.corrected = c.estimate;
            f.log_likelihood += c.log_likelihood;
            f.distances.push_back(c.squared_distance);
            f.steps.push_back(step);
        }
        return f;
    }
};

struct Consistency {
    double estimate_error = 0, innovation = 0;
};

/// Means over runs of the squared distance of the last estimate's error (NEES) and of the last
/// innovation (NIS).
Consistency consistency(double noise_factor, int runs) {
    Consistency mean;
    for (int run = 0; run < runs; ++run) {
        const Walk walk(1000 + static_cast<std::uint64_t>(run), 60);
        const Walk::Filtered f = walk.filtered(noise_factor);
        mean.estimate_error += squared_distance(f.steps.back().corrected, walk.truth.back()) / runs;
        mean.innovation += f.distances.back() / runs;
    }
    return mean;
}

bool positive(const Eigen::Matrix2f& m) {
    return m(0, 0) >= 0 && m(1, 1) >= 0 && m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) >= 0;
}

/// Repeated updates with two measurements of nearly the same combination of two variables.
struct IllConditioned {
    float eps;
    Eigen::Matrix2f seen(int k) const {
        // no two successive updates are equal
        const float spread = 1 + static_cast<float>(k % 7) / 7;
        Eigen::Matrix2f H;
        H << 1, 1, 1, 1 + std::sqrt(eps);
        return spread * H;
    }
    Eigen::Matrix2f noise() const { return Eigen::Matrix2f::Identity() * eps; }
    Eigen::Matrix2f growth() const { return Eigen::Matrix2f::Identity() * 1e-3f; }
};

bool short_form_fails(const IllConditioned& c) {
    Eigen::Matrix2f P = Eigen::Matrix2f::Identity();
    for (int k = 0; k < 1000; ++k) {
        P += c.growth();
        const Eigen::Matrix2f H = c.seen(k),
                              K = P * H.transpose() *
                                  Eigen::Matrix2f(H * P * H.transpose() + c.noise()).inverse();
        P -= K * H * P;
        if (!positive(P)) return true;
    }
    return false;
}

} // namespace

TEST_SUITE("engine/estimation/kalman") {
    TEST_CASE("steady-state gains agree with the closed form and with the Riccati equation") {
        // Kalata (1984): index lambda, T = R = 1
        for (const double l : {0.1, 1.0}) {
            const SteadyState s = run_until_steady(constant_acceleration(1, 1, l * l));
            const double root = std::sqrt(l * l + 8 * l);
            CHECK(s.position_gain == about(-(l * l + 8 * l - (l + 4) * root) / 8).epsilon(1e-9));
            CHECK(s.velocity_gain == about((l * l + 4 * l - l * root) / 4).epsilon(1e-9));
        }
        // white-noise acceleration: solutions of the discrete Riccati equation by another program
        const SteadyState weak = run_until_steady(white_acceleration(1, 1, 0.01)),
                          strong = run_until_steady(white_acceleration(1, 1, 100));
        CHECK(weak.position_gain == about(0.360591664527).epsilon(1e-9));
        CHECK(weak.velocity_gain == about(0.079963012417).epsilon(1e-9));
        CHECK(strong.velocity_gain == about(1.191506858313).epsilon(1e-9));
        CHECK(strong.predicted_variance == about(69.43798229024).epsilon(1e-9));
    }

    TEST_CASE("the variances of a scalar random walk before and after updates solve its Riccati "
              "equation") {
        // P = P R / (P + R) + Q
        for (const auto& [q, r] : {std::pair{1.0, 1.0}, {0.01, 4.0}, {100.0, 0.5}}) {
            const Transition walk{scalar(1), scalar(q)};
            Gaussian x(Vector::Zero(1), scalar(50)), predicted;
            for (int k = 0; k < 500; ++k) {
                predicted = predict(x, walk);
                x = update<double>(predicted, Vector::Zero(1), scalar(1), scalar(r)).estimate;
            }
            const double before = 0.5 * (q + std::sqrt(q * q + 4 * q * r));
            CAPTURE(q);
            CHECK(predicted.covariance()(0, 0) == about(before).epsilon(1e-12));
            CHECK(x.covariance()(0, 0) == about(before - q).epsilon(1e-12));
        }
    }

    TEST_CASE("an update agrees with Joseph's form for correlated and for perfect measurements") {
        Random random(3, 0);
        Matrix A(4, 4), H(2, 4);
        for (double& x : A.reshaped()) x = random.normal();
        for (double& x : H.reshaped()) x = random.normal();
        Eigen::Matrix2d R;
        R << 2, 0.7, 0.7, 1;
        const Gaussian before(numbers({1, 2, 3, 4}), A * A.transpose());
        const Matrix P = before.covariance(), one = Matrix::Identity(4, 4);
        const Vector y = numbers({0.3, -2});
        for (const double factor : {1.0, 0.0}) {
            const auto c = update<double>(before, y, H, factor * R);
            const Eigen::Matrix2d S = H * P * H.transpose() + factor * R, inverse = S.inverse();
            const Matrix K = P * H.transpose() * inverse;
            const Vector innovation = y - H * before.mean;
            CHECK((c.gain - K).norm() < 1e-12 * K.norm());
            CHECK((c.estimate.mean - before.mean - K * innovation).norm() <
                  1e-12 * before.mean.norm());
            CHECK((c.estimate.covariance() - (one - K * H) * P * (one - K * H).transpose() -
                   factor * K * R * K.transpose())
                      .norm() < 1e-12 * P.norm());
            const double distance = innovation.dot(inverse * innovation);
            CHECK(c.squared_distance == about(distance).epsilon(1e-11));
            CHECK(c.log_likelihood ==
                  about(-0.5 * (distance + std::log(S.determinant()) + 2 * std::log(2 * pi)))
                      .epsilon(1e-11));
        }
    }

    TEST_CASE("a covariance with zero variances has a root") {
        Matrix P(3, 3);
        P << 0, 0, 0, 0, 4, 2, 0, 2, 1; // singular twice
        const Matrix root = root_of<double>(P);
        CHECK((root * root.transpose() - P).norm() < 1e-14);
        CHECK(root_of<double>(Matrix::Zero(3, 3)).norm() == 0);
    }

    TEST_CASE("the last estimate and the likelihood agree with one update by all measurements at "
              "once") {
        constexpr Eigen::Index steps = 60, n = 2 * steps;
        const Walk walk(7, steps);
        const Walk::Filtered f = walk.filtered(1);
        // joint normal distribution of the states of all steps, updated once by all measurements
        Matrix P = Matrix::Zero(n, n), H = Matrix::Zero(steps, n), now = walk.before.covariance();
        Vector y(steps);
        for (Eigen::Index k = 0; k < steps; ++k) {
            now = walk.t.F * now * walk.t.F.transpose() + walk.t.Q;
            Matrix later = now;
            for (Eigen::Index j = k; j < steps; ++j, later = walk.t.F * later) {
                P.block<2, 2>(2 * j, 2 * k) = later;
                P.block<2, 2>(2 * k, 2 * j) = later.transpose();
            }
            H(k, 2 * k) = 1;
            y[k] = walk.y[static_cast<std::size_t>(k)];
        }
        const auto batch = update<double>(Gaussian(Vector::Zero(n), P), y, H,
                                          walk.variance * Matrix::Identity(steps, steps));
        const Matrix covariance = batch.estimate.covariance();
        const Gaussian& last = f.steps.back().corrected;
        CHECK((last.mean - batch.estimate.mean.tail<2>()).norm() < 1e-10);
        CHECK((last.covariance() - covariance.bottomRightCorner<2, 2>()).norm() < 1e-10);
        CHECK(f.log_likelihood == about(batch.log_likelihood).epsilon(1e-10));
    }

    TEST_CASE("errors and innovations agree with the filter's covariance, but not if it assumes "
              "ten times as much or as little noise") {
        constexpr int runs = 400;
        const testing::Band errors = testing::chi_squared_band(0.95, 2, runs),
                            innovations = testing::chi_squared_band(0.95, 1, runs);
        const Consistency right = consistency(1, runs), much = consistency(10, runs),
                          little = consistency(0.1, runs);
        CHECK(errors.holds(right.estimate_error));
        CHECK(innovations.holds(right.innovation));
        CHECK(much.estimate_error < errors.low);
        CHECK(much.innovation < innovations.low);
        CHECK(little.estimate_error > errors.high);
        CHECK(little.innovation > innovations.high);
    }

    TEST_CASE("innovations of a correct model are white") {
        constexpr std::size_t steps = 4000;
        const Walk walk(11, steps);
        std::vector<double> innovations;
        for (const FilterStep& step : walk.filtered(1).steps) {
            const double spread = std::sqrt(step.predicted.covariance()(0, 0) + walk.variance);
            innovations.push_back((walk.y[innovations.size()] - step.predicted.mean[0]) / spread);
        }
        for (const std::size_t lag : {1u, 2u, 5u}) {
            double sum = 0;
            for (std::size_t k = lag; k < steps; ++k) sum += innovations[k] * innovations[k - lag];
            CHECK(std::abs(sum / steps) < 1.96 / std::sqrt(static_cast<double>(steps)));
        }
    }

    TEST_CASE("chi-squared bands agree with tables") {
        CHECK(testing::chi_squared_band(0.95, 2, 50).low == about(1.484439).epsilon(1e-6));
        CHECK(testing::chi_squared_band(0.95, 2, 50).high == about(2.591224).epsilon(1e-6));
        CHECK(testing::chi_squared_band(0.999, 15, 1).high == about(39.718760).epsilon(1e-6));
    }

    TEST_CASE("a covariance stays positive over a million updates in single precision, where P - K "
              "H P fails within a thousand") {
        for (const float eps : {1e-8f, 1e-12f, 1e-15f, 1e-17f}) {
            const IllConditioned c{eps};
            CAPTURE(eps);
            CHECK(short_form_fails(c));
            GaussianOf<float> x(VectorOf<float>::Zero(2), MatrixOf<float>::Identity(2, 2));
            const TransitionOf<float> grow{MatrixOf<float>::Identity(2, 2), c.growth()};
            for (int k = 0; k < 250000; ++k)
                x = update<float>(predict(x, grow), VectorOf<float>::Zero(2), c.seen(k), c.noise())
                        .estimate;
            // so that root root^T is symmetric and positive semi-definite
            CHECK(x.root.allFinite());
            // variance of the sum, which is measured; the difference hardly is
            CHECK((x.root.row(0) + x.root.row(1)).squaredNorm() < 1e-6f);
        }
    }

    TEST_CASE("an update that leaves very little variance is accurate where P - K H P is only "
              "rounding noise") {
        // H = [1 1; 1 1 + sqrt(eps)], P = 1, R = eps: values by exact rational arithmetic
        Matrix H(2, 2);
        H << 1, 1, 1, 1.000001;
        const auto c = update<double>(Gaussian(Vector::Zero(2), Matrix::Identity(2, 2)),
                                      Vector::Zero(2), H, 1e-12 * Matrix::Identity(2, 2));
        CHECK(c.estimate.covariance()(0, 0) == about(0.400000240000144).epsilon(1e-3));
        CHECK(c.estimate.covariance()(0, 1) == about(-0.400000039999824).epsilon(1e-3));
    }

    TEST_CASE("k steps of T/k predict the same as one of T, and the variance without measurements "
              "grows as in the closed form") {
        const Gaussian start(Vector::Constant(6, 0.5), Matrix::Identity(6, 6) * 0.01);
        const Gaussian once = predict(start, white_acceleration(3, 2, 0.3));
        Gaussian often = start;
        for (int k = 0; k < 8; ++k) often = predict(often, white_acceleration(3, 0.25, 0.3));
        CHECK((once.covariance() - often.covariance()).norm() < 1e-14 * once.covariance().norm());
        CHECK((once.mean - often.mean).norm() < 1e-14);
        CHECK(once.covariance()(0, 0) == about(0.01 + 4 * 0.01 + 0.3 * 8 / 3).epsilon(1e-14));
    }

    TEST_CASE(
        "the algorithm as printed never fuses rotation, and its covariance is not symmetric") {
        const Transition t = white_acceleration(3, 0.5, 1);
        const Matrix one = Matrix::Identity(3, 3);
        PrintedFilter filter{.A = t.F, .Q = t.Q, .R = Matrix::Identity(6, 6), .q = one, .r = one};
        Vector simulated = Vector::Zero(6), angular_velocity = Vector::Zero(3);
        double asymmetry = 0;
        for (int k = 0; k < 800; ++k) {
            simulated = filter.fuse(simulated, Vector::Ones(6));
            angular_velocity = filter.fuse_angular_velocity(angular_velocity, numbers({1, 2, 3}));
            asymmetry = std::max(asymmetry, (filter.COV - filter.COV.transpose()).norm());
        }
        CHECK(angular_velocity.norm() == 0);
        CHECK(filter.angular_velocity_gain.norm() == 0);
        CHECK(filter.gain.norm() > 0); // translation is fused
        CHECK(asymmetry > 0.01);
    }
}
