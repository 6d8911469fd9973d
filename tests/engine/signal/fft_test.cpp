#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/fft.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace bris;

namespace {

std::vector<double> random_series(std::size_t n, std::uint64_t seed) {
    Random random(seed, n);
    std::vector<double> x(n);
    for (double& value : x) value = random.normal();
    return x;
}

} // namespace

TEST_SUITE("engine/signal/fft") {
    TEST_CASE("the transform equals the sum of its definition at every fast length up to 100") {
        for (std::size_t n = 1; n <= 100; ++n) {
            if (!is_fast_length(n)) continue;
            const auto x = random_series(n, 5);
            const auto fast = Fft(n).transform(x);
            REQUIRE(fast.size() == n / 2 + 1);
            for (std::size_t k = 0; k < fast.size(); ++k) {
                std::complex<double> sum = 0;
                for (std::size_t t = 0; t < n; ++t)
                    sum += x[t] * std::polar(1.0, -2 * pi * static_cast<double>(k * t % n) /
                                                      static_cast<double>(n));
                CAPTURE(n);
                CHECK(std::abs(fast[k] - sum) < 1e-13 * std::sqrt(static_cast<double>(n)) * 10);
            }
        }
    }

    TEST_CASE("a series comes back from its transform at every fast length up to 100") {
        for (std::size_t n = 1; n <= 100; ++n) {
            if (!is_fast_length(n)) continue;
            const auto x = random_series(n, 6);
            Fft fft(n);
            const auto back = fft.series_of(fft.transform(x));
            for (std::size_t k = 0; k < n; ++k) CHECK(std::abs(back[k] - x[k]) < 1e-13);
        }
        CHECK_THROWS_AS(Fft(6).series_of(std::vector<std::complex<double>>(6)), InputError);
        CHECK(fast_length_for(97) == 100);
        CHECK(fast_length_for(0) == 1);
    }

    TEST_CASE("one plan transforms several series alike") {
        Fft fft(720);
        const auto x = random_series(720, 1), y = random_series(720, 2);
        const auto first = fft.transform(x);
        (void)fft.transform(y);
        CHECK(fft.transform(x) == first);
    }

    TEST_CASE(
        "lengths with a prime factor above 5 are refused, and the next shorter one is found") {
        CHECK_THROWS_AS(Fft(4099), InputError);
        CHECK_THROWS_AS(Fft(14), InputError);
        CHECK_THROWS_AS(Fft(0), InputError);
        CHECK(fast_length_within(4099) == 4096);
        CHECK(fast_length_within(1000) == 1000);
        CHECK(fast_length_within(999) == 972);
        CHECK(fast_length_within(7) == 6);
        CHECK_THROWS_AS((void)Fft(8).transform(std::vector<double>(9)), InputError);
    }
}
