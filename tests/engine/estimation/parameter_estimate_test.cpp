#include "engine/errors.hpp"
#include "engine/estimation/parameter_estimate.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"
#include "tests/engine/estimation/chi_squared_band.hpp"

#include <doctest/doctest.h>

#include <array>
#include <utility>

using namespace bris;

namespace {

/// A synthetic experiment with known truth: a linear or curved function of two parameters at each
/// time, with correlated divergence.
struct Game {
    std::uint64_t seed = 1;
    Eigen::Index members = 10;
    double divergence = 0.1, lasting = 0, curvature = 0, noise = 0.01;
    int times = 8;

    Gaussian prior() const {
        Gaussian g(2);
        g.mean << -0.7, 0.2;
        g.root.diagonal() << 0.3, 0.4;
        return g;
    }
    double law(int time, const Vector& x) const {
        const double slope = 1.0 / (1 + 0.3 * time), d = x[0] + 0.7;
        return 2 + 0.1 * time + 0.8 * x[0] + slope * x[1] + curvature * d * d;
    }
    /// Draws the true parameters from the prior and estimates them. Returns the squared distance of
    /// the truth from the estimate.
    double play(Gaussian* learned = nullptr) const {
        Random random(seed, 7);
        const Gaussian before = prior();
        const auto draw = [&]() -> Vector {
            Vector x(2);
            x << before.mean[0] + before.root(0, 0) * random.normal(),
                before.mean[1] + before.root(1, 1) * random.normal();
            return x;
        };
        const Vector truth = draw();
        Matrix designs(members, 2);
        for (Eigen::Index j = 0; j < members; ++j) designs.row(j) = draw().transpose();
        ParameterEstimate estimate(before, designs, 1);
        Vector state(members + 1); // divergence of each member and of the real specimen
        for (double& s : state) s = divergence * random.normal();
        for (int t = 0; t < times; ++t) {
            Vector forecast(members);
            for (Eigen::Index j = 0; j < members; ++j)
                forecast[j] = law(t, designs.row(j)) + state[j];
            estimate.observe(0, forecast,
                             {law(t, truth) + state[members] + noise * random.normal(), noise});
            for (double& s : state)
                s = lasting * s + divergence * std::sqrt(1 - lasting * lasting) * random.normal();
        }
        if (learned) *learned = estimate.parameters();
        return squared_distance(estimate.parameters(), truth);
    }
    double mean_distance(int games) {
        double sum = 0;
        for (int g = 0; g < games; ++g) {
            seed = static_cast<std::uint64_t>(g + 1);
            sum += play() / games;
        }
        return sum;
    }
};

Matrix random_members(Eigen::Index count) {
    Random random(1, 1);
    Matrix members(count, 2);
    for (double& x : members.reshaped()) x = random.normal();
    return members;
}

} // namespace

TEST_SUITE("engine/estimation/parameter_estimate") {
    TEST_CASE("with little divergence and noise the parameters are found from three measurements") {
        Game game{.divergence = 1e-3, .noise = 1e-4, .times = 3};
        Gaussian learned;
        (void)game.play(&learned);
        CHECK(std::sqrt(learned.covariance().diagonal().maxCoeff()) < 0.02);
    }

    TEST_CASE("the estimated covariance agrees with the errors, whether the divergence is "
              "correlated or not") {
        const testing::Band band =
            testing::chi_squared_band(0.99, 2, 150); // of the mean over 150 games
        for (const double lasting : {0.0, 0.6, 0.95}) {
            CAPTURE(lasting);
            Game game{.lasting = lasting};
            const double distance = game.mean_distance(150);
            // slopes from only ten members make the estimate slightly conservative
            CHECK(distance > 0.6 * band.low);
            // a correlation estimated from the members makes it slightly overconfident
            CHECK(distance < 1.3 * band.high);
        }
    }

    TEST_CASE("a curved law needs at least twelve members, and then does no harm") {
        Game line{.members = 10, .divergence = 0.02, .curvature = 0.7}, curve = line;
        curve.members = 14;
        const double by_line = line.mean_distance(60), by_curve = curve.mean_distance(60);
        CHECK(by_curve < 3);
        CHECK(by_curve < 0.5 * by_line);
    }

    TEST_CASE("without divergence the estimate agrees with a Kalman update") {
        Gaussian exact = Game{}.prior();
        exact.root(1, 0) = 0.1;
        const Matrix members = random_members(11);
        ParameterEstimate estimate(exact, members, 2);
        for (const auto& [channel, y] : {std::pair{0, -0.1}, {1, -0.3}}) {
            Matrix slope(1, 2);
            slope << 0.8, channel ? 0.5 : 1.0;
            estimate.observe(static_cast<std::size_t>(channel), members * slope.transpose(),
                             {y, 0.03});
            exact = update<double>(exact, Vector::Constant(1, y), slope,
                                   Matrix::Constant(1, 1, 0.03 * 0.03))
                        .estimate;
        }
        const Gaussian& found = estimate.parameters();
        // Student's t with eight degrees of freedom instead of the normal: slightly wider, slightly
        // less correction
        CHECK((found.mean - exact.mean).norm() < 0.05);
        for (Eigen::Index p = 0; p < 2; ++p)
            CHECK(std::sqrt(found.covariance()(p, p) / exact.covariance()(p, p)) ==
                  about(1.1).epsilon(0.1));
    }

    TEST_CASE("the scatter of the specimen is weighted as in generalised least squares") {
        const Gaussian before = Game{}.prior();
        const Matrix members = random_members(9);
        const std::array<double, 3> stages{0, 0.7, 3};
        ParameterEstimate estimate(before, members, 1, 1, 0, {.memory = 2});
        Matrix slopes(3, 2), process(3, 3);
        slopes << 0.8, 1, 0.8, 0.6, 0.8, 0.1;
        Vector measured(3);
        measured << 0.1, 0.3, -0.4;
        for (Eigen::Index k = 0; k < 3; ++k) {
            const double stage = stages[static_cast<std::size_t>(k)];
            estimate.observe(0, members * slopes.row(k).transpose(), {measured[k], 0, 0.2, stage});
            for (Eigen::Index l = 0; l < 3; ++l)
                process(k, l) =
                    0.04 * std::exp(-std::abs(stage - stages[static_cast<std::size_t>(l)]) / 2);
        }
        const Gaussian exact = update<double>(before, measured, slopes, process).estimate,
                       &found = estimate.parameters();
        CHECK((found.mean - exact.mean).norm() < 1e-3);
        // limited by the spacing of the nodes
        CHECK((found.covariance() - exact.covariance()).norm() < 0.04 * exact.covariance().norm());
    }

    TEST_CASE("a deviation of the specimen that two channels share counts once") {
        const Gaussian before = Game{}.prior();
        const Matrix members = random_members(9);
        Matrix slopes(4, 2), process(4, 4);
        slopes << 0.8, 0.5, 0.7, 0.2, 1.1, 0, 1, 0.1;
        const std::array<double, 4> stage{0, 1, 0, 1}, scatter{0.2, 0.2, 0.3, 0.4};
        const std::array<std::size_t, 4> channel{0, 0, 1, 1};
        Vector measured(4);
        measured << 0.1, 0.2, 0.4, 0.3;
        const auto learned = [&](double specimen_correlation) {
            ParameterEstimate estimate(before, members, 2, 1, 0,
                                       {.memory = 3, .channels = specimen_correlation});
            for (const Eigen::Index k : {0, 2, 1, 3}) { // in order of time
                const auto at = static_cast<std::size_t>(k);
                estimate.observe(channel[at], members * slopes.row(k).transpose(),
                                 {measured[k], 0, scatter[at], stage[at]});
                for (std::size_t l = 0; l < 4; ++l)
                    process(k, static_cast<Eigen::Index>(l)) =
                        scatter[at] * scatter[l] *
                        (channel[at] == channel[l] ? 1 : specimen_correlation) *
                        std::exp(-std::abs(stage[at] - stage[l]) / 3);
            }
            return estimate.parameters();
        };
        const Gaussian found = learned(0.6),
                       exact = update<double>(before, measured, slopes, process).estimate;
        CHECK((found.mean - exact.mean).norm() < 1e-3);
        CHECK((found.covariance() - exact.covariance()).norm() < 0.04 * exact.covariance().norm());
        CHECK(learned(0).covariance()(0, 0) < 0.95 * found.covariance()(0, 0));
    }

    TEST_CASE("a narrow ridge of the likelihood is found in any direction, many deviations from "
              "the prior") {
        Matrix members(8, 2);
        members << -0.4, 0, -1, 0.4, -0.7, 0.6, -0.5, -0.3, -0.9, 0.1, -0.7, -0.2, -0.2, 0.5, -1.1,
            0.2;
        ParameterEstimate estimate(Game{}.prior(), members, 1);
        // 7 prior deviations of the sum
        estimate.observe(0, members.col(0) + members.col(1), {3, 1e-3});
        const Gaussian& found = estimate.parameters();
        CHECK(found.mean.sum() == about(3).epsilon(2e-3));
        CHECK((found.root.transpose() * Vector::Ones(2)).norm() < 5e-3);
        CHECK(std::sqrt(found.covariance()(0, 0)) == about(0.3 * 0.4 / 0.5).epsilon(0.1));
    }

    TEST_CASE("a specimen with scatter of its own reduces the information of a measurement") {
        const Gaussian prior = Game{}.prior();
        Matrix members(6, 2);
        members << -0.4, 0, -1, 0.4, -0.7, 0.6, -0.5, -0.3, -0.9, 0.1, -0.7, -0.2;
        const auto deviation_with = [&](double scatter) {
            ParameterEstimate estimate(prior, members, 1);
            Vector forecast(6);
            for (Eigen::Index j = 0; j < 6; ++j)
                forecast[j] = Game{}.law(0, members.row(j)) + 1e-3 * (j % 2 ? 1 : -1);
            estimate.observe(0, forecast, {1.5, 0.01, scatter});
            // the sum that was measured
            const Vector observations = Vector::Map(std::array{0.8, 1.0}.data(), 2);
            return std::sqrt(observations.dot(estimate.parameters().covariance() * observations));
        };
        CHECK(deviation_with(0) < 0.1);
        // 0.3 combined with the prior's 0.47
        CHECK(deviation_with(0.3) == about(0.25).epsilon(0.2));
    }

    TEST_CASE("the weights of members sum to one and reproduce a linear function exactly") {
        Matrix members(5, 2);
        members << 0, 0, 1, 0.5, -1, 0.2, 0.3, -1, 0.7, 0.7;
        Vector at(2), line(5);
        at << 0.4, -0.3;
        for (Eigen::Index j = 0; j < 5; ++j) line[j] = 3 - 2 * members(j, 0) + 5 * members(j, 1);
        const Vector weights = EnsembleRegression(members).weights_at(at);
        CHECK(weights.sum() == about(1).epsilon(1e-12));
        CHECK(weights.dot(line) == about(3 - 0.8 - 1.5).epsilon(1e-12));
        CHECK((EnsembleRegression(members).residual_projection() * line).norm() < 1e-12);
    }

    TEST_CASE("a channel without measurements has no normalised innovation, and another one does "
              "not change that") {
        Matrix members(6, 2);
        members << -0.7, 0.2, -0.4, 0.3, -0.9, 0.1, -0.6, 0.5, -0.8, -0.2, -0.5, 0;
        ParameterEstimate estimate(Game{}.prior(), members, 2);
        CHECK(std::isnan(estimate.normalised_innovation_squared(0)));
        Vector forecast(6);
        forecast << 1, 1.2, 0.9, 1.1, 0.8, 1.3;
        estimate.observe(0, forecast, {1.4, 0.01});
        CHECK(estimate.normalised_innovation_squared(0) > 0);
        CHECK(std::isnan(estimate.normalised_innovation_squared(1)));
    }

    TEST_CASE("too few members, and members with equal parameters, are rejected") {
        const Gaussian prior = Game{}.prior();
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(5, 2), 1), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Zero(8, 2), 1), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(8, 3), 1), InputError);
    }
}
