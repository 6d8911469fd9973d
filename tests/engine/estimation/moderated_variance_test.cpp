#include "engine/estimation/moderated_variance.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// A mean of `freedom` squared standard normal numbers.
double mean_square(Random& random, int freedom) {
    double sum = 0;
    for (int k = 0; k < freedom; ++k) {
        const double x = random.normal();
        sum += x * x;
    }
    return sum / freedom;
}

} // namespace

TEST_SUITE("engine/estimation/moderated_variance") {
    TEST_CASE("variances with log-normal scatter are estimated better together than each by "
              "itself, with the error of the posterior mean") {
        // standard deviation of the logarithms of the true variances, and variance of the logarithm
        // of a mean of 15 squares (Abramowitz and Stegun 6.4)
        constexpr double spread = 0.6, trigamma = 0.142611;
        Random random(11, 2);
        std::vector<double> logarithm, raw;
        for (int k = 0; k < 20000; ++k) {
            logarithm.push_back(std::log(4) + spread * random.normal());
            raw.push_back(std::exp(logarithm.back()) * mean_square(random, 15));
        }
        const auto moderated = moderated_variances(raw, 15);
        double by_itself = 0, together = 0;
        for (std::size_t k = 0; k < raw.size(); ++k) {
            by_itself += std::pow(std::log(raw[k]) - logarithm[k], 2) / 20000;
            together += std::pow(std::log(moderated[k]) - logarithm[k], 2) / 20000;
        }
        CHECK(by_itself == about(trigamma).epsilon(0.06)); // with a small bias
        CHECK(together == about(1 / (1 / trigamma + 1 / (spread * spread))).epsilon(0.05));
    }

    TEST_CASE("variances that differ only by sampling scatter become equal, and zero variances "
              "stay zero") {
        Random random(12, 2);
        std::vector<double> raw{0};
        for (int k = 0; k < 2000; ++k) raw.push_back(1e-8 * mean_square(random, 15));
        const auto moderated = moderated_variances(raw, 15);
        CHECK(moderated[0] == 0);
        for (std::size_t k = 1; k < raw.size(); k += 50)
            CHECK(moderated[k] == about(1e-8).epsilon(0.12));
    }

    TEST_CASE("three variances are too few to be moderated") {
        CHECK(moderated_variances({2, 3, 9}, 3) == std::vector<double>{2, 3, 9});
    }
}
