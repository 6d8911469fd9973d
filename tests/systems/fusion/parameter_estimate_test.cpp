#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "engine/signal/chi_squared.hpp"
#include "systems/fusion/parameter_estimate.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace bris;

namespace {

/// An experiment in which everything is known: a line, or a curve, of two parameters at each time, and chaos that lasts.
struct Game {
    std::uint64_t seed = 1;
    Eigen::Index worlds = 10;
    double chaos = 0.1, lasting = 0, curvature = 0, noise = 0.01;
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
    /// Draws a truth from the prior and lets it be learned. Squared distance of the truth from the estimate.
    double play(Gaussian* learned = nullptr) const {
        Random random(seed, 7);
        const Gaussian before = prior();
        const auto draw = [&]() -> Vector {
            Vector x(2);
            x << before.mean[0] + before.root(0, 0) * random.normal(), before.mean[1] + before.root(1, 1) * random.normal();
            return x;
        };
        const Vector truth = draw();
        Matrix designs(worlds, 2);
        for (Eigen::Index j = 0; j < worlds; ++j) designs.row(j) = draw().transpose();
        ParameterEstimate estimate(before, designs, {{0, noise}});
        Vector state(worlds + 1); // chaos of each world, and of the real one
        for (double& s : state) s = chaos * random.normal();
        for (int t = 0; t < times; ++t) {
            Vector foretold(worlds);
            for (Eigen::Index j = 0; j < worlds; ++j) foretold[j] = law(t, designs.row(j)) + state[j];
            (void)estimate.see(0, foretold, law(t, truth) + state[worlds] + noise * random.normal());
            for (double& s : state) s = lasting * s + chaos * std::sqrt(1 - lasting * lasting) * random.normal();
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

} // namespace

TEST_SUITE("fusion/parameter_estimate") {
    TEST_CASE("without much chaos and noise the parameters are found from three measurements") {
        Game game{.chaos = 1e-3, .noise = 1e-4, .times = 3};
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
            CHECK(distance > 0.6 * band.low); // slopes known from ten worlds only make it a little careful
            CHECK(distance < 1.3 * band.high); // and a memory estimated from them a little too sure
        }
    }

    TEST_CASE("a curved law needs twelve worlds, and then does no harm") {
        Game line{.worlds = 10, .chaos = 0.02, .curvature = 0.7}, curve = line;
        curve.worlds = 14;
        const double by_line = line.mean_distance(60), by_curve = curve.mean_distance(60);
        CHECK(by_curve < 3);
        CHECK(by_curve < 0.5 * by_line);
    }

    TEST_CASE("a real specimen that may be stronger for other reasons teaches less") {
        const Gaussian prior = Game{}.prior();
        Matrix worlds(6, 2);
        worlds << -0.4, 0, -1, 0.4, -0.7, 0.6, -0.5, -0.3, -0.9, 0.1, -0.7, -0.2;
        const auto deviation_with = [&](double scatter) {
            ParameterEstimate estimate(prior, worlds, {{scatter, 0.01}});
            Vector foretold(6);
            for (Eigen::Index j = 0; j < 6; ++j) foretold[j] = Game{}.law(0, worlds.row(j)) + 1e-3 * (j % 2 ? 1 : -1);
            (void)estimate.see(0, foretold, 1.5);
            const Vector seen = Vector::Map(std::array{0.8, 1.0}.data(), 2); // the sum that was measured
            return std::sqrt(seen.dot(estimate.parameters().covariance() * seen));
        };
        CHECK(deviation_with(0) < 0.1);
        CHECK(deviation_with(0.3) == doctest::Approx(0.25).epsilon(0.2)); // that of 0.3 and the prior's 0.47 together
    }

    TEST_CASE("weights of worlds sum to one and give back a line exactly") {
        Matrix worlds(5, 2);
        worlds << 0, 0, 1, 0.5, -1, 0.2, 0.3, -1, 0.7, 0.7;
        Vector at(2), line(5);
        at << 0.4, -0.3;
        for (Eigen::Index j = 0; j < 5; ++j) line[j] = 3 - 2 * worlds(j, 0) + 5 * worlds(j, 1);
        const Vector weights = WorldRegression(worlds).weights_at(at);
        CHECK(weights.sum() == doctest::Approx(1).epsilon(1e-12));
        CHECK(weights.dot(line) == doctest::Approx(3 - 0.8 - 1.5).epsilon(1e-12));
        CHECK((WorldRegression(worlds).leaves() * line).norm() < 1e-12);
    }

    TEST_CASE("too few worlds, and worlds that are all alike, are refused") {
        const Gaussian prior = Game{}.prior();
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(5, 2), {{0, 0.01}}), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Zero(8, 2), {{0, 0.01}}), InputError);
        CHECK_THROWS_AS(ParameterEstimate(prior, Matrix::Random(8, 3), {{0, 0.01}}), InputError);
    }
}
