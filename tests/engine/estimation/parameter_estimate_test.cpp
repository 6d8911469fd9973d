#include "engine/errors.hpp"
#include "engine/estimation/chi_squared.hpp"
#include "engine/estimation/parameter_estimate.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <array>
#include <utility>

using namespace bris;

namespace {

/// An experiment in which everything is known: a line, or a curve, of two parameters at each time,
/// and chaos that lasts.
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
    /// Draws a truth from the prior and lets it be learned. Squared distance of the truth from the
    /// estimate.
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
        Vector state(members + 1); // chaos of each world, and of the real one
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

TEST_SUITE("fusion/parameter_estimate") {
    TEST_CASE("without much chaos and noise the parameters are found from three measurements") {
        Game game{.divergence = 1e-3, .noise = 1e-4, .times = 3};
        Gaussian learned;
        (void)game.play(&learned);
        CHECK(std::sqrt(learned.covariance().diagonal().maxCoeff()) < 0.02);
    }

    TEST_CASE("what is learned is as uncertain as it says, whether chaos lasts or not") {
        const Band band = chi_squared_band(0.99, 2, 150); // of the mean over 150 games
        for (const double lasting : {0.0, 0.6, 0.95}) {
            CAPTURE(lasting);
            Game game{.lasting = lasting};
            const double distance = game.mean_distance(150);
            CHECK(distance >
                  0.6 * band.low); // slopes known from ten worlds only make it a little careful
            CHECK(distance < 1.3 * band.high); // and a memory estimated from them a little too sure
        }
    }

    TEST_CASE("a curved law needs twelve worlds, and then does no harm") {
        Game line{.members = 10, .divergence = 0.02, .curvature = 0.7}, curve = line;
        curve.members = 14;
        const double by_line = line.mean_distance(60), by_curve = curve.mean_distance(60);
        CHECK(by_curve < 3);
        CHECK(by_curve < 0.5 * by_line);
    }

    TEST_CASE("where worlds hold no chaos, what is learned is what Kalman's update says") {
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
        // Student's t of eight degrees in the place of the normal: a little wider, a little less
        // moved
        CHECK((found.mean - exact.mean).norm() < 0.05);
        for (Eigen::Index p = 0; p < 2; ++p)
            CHECK(std::sqrt(found.covariance()(p, p) / exact.covariance()(p, p)) ==
                  about(1.1).epsilon(0.1));
    }

    TEST_CASE("a specimen that differs by a process of its own is weighed as generalised least "
              "squares weigh it") {
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
        CHECK((found.covariance() - exact.covariance()).norm() <
              0.04 * exact.covariance().norm()); // never finer than the nodes stand
    }

    TEST_CASE("what two channels share of a specimen's difference counts once") {
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
            for (const Eigen::Index k : {0, 2, 1, 3}) { // in the order of time
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

    TEST_CASE("a narrow ridge is found wherever it runs, from a start many deviations off") {
        Matrix members(8, 2);
        members << -0.4, 0, -1, 0.4, -0.7, 0.6, -0.5, -0.3, -0.9, 0.1, -0.7, -0.2, -0.2, 0.5, -1.1,
            0.2;
        ParameterEstimate estimate(Game{}.prior(), members, 1);
        estimate.observe(0, members.col(0) + members.col(1), {3, 1e-3}); // 7 of its deviations
        const Gaussian& found = estimate.parameters();
        CHECK(found.mean.sum() == about(3).epsilon(2e-3));
        CHECK((found.root.transpose() * Vector::Ones(2)).norm() < 5e-3);
        CHECK(std::sqrt(found.covariance()(0, 0)) == about(0.3 * 0.4 / 0.5).epsilon(0.1));
    }

    TEST_CASE("a real specimen that may be stronger for other reasons teaches less") {
        const Gaussian prior = Game{}.prior();
        Matrix members(6, 2);
        members << -0.4, 0, -1, 0.4, -0.7, 0.6, -0.5, -0.3, -0.9, 0.1, -0.7, -0.2;
        const auto deviation_with = [&](double scatter) {
            ParameterEstimate estimate(prior, members, 1);
            Vector forecast(6);
            for (Eigen::Index j = 0; j < 6; ++j)
                forecast[j] = Game{}.law(0, members.row(j)) + 1e-3 * (j % 2 ? 1 : -1);
            estimate.observe(0, forecast, {1.5, 0.01, scatter});
            const Vector observations =
                Vector::Map(std::array{0.8, 1.0}.data(), 2); // the sum that was measured
            return std::sqrt(observations.dot(estimate.parameters().covariance() * observations));
        };
        CHECK(deviation_with(0) < 0.1);
        CHECK(deviation_with(0.3) ==
              about(0.25).epsilon(0.2)); // that of 0.3 and the prior's 0.47 together
    }

    TEST_CASE("weights of worlds sum to one and give back a line exactly") {
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

    TEST_CASE("too few worlds, and worlds that are all alike, are refused") {
        const Gaussian prior = Game{}.prior();
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(5, 2), 1), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Zero(8, 2), 1), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(8, 3), 1), InputError);
    }
}
