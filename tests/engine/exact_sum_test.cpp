#include "engine/exact_sum.hpp"
#include "engine/random.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

using namespace bris;

namespace {

/// Wide enough for any sum of doubles.
using Wide = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<2300, boost::multiprecision::digit_base_2>,
    boost::multiprecision::et_off>;

double exact(const std::vector<double>& terms) {
    ExactSum sum;
    for (const double x : terms) sum.add(x);
    return sum.value();
}

double wide(const std::vector<double>& terms) {
    Wide sum = 0;
    for (const double x : terms) sum += x;
    return static_cast<double>(sum);
}

} // namespace

TEST_SUITE("engine/exact_sum") {
    TEST_CASE("a sum is rounded once, at its end") {
        constexpr double tiny = std::numeric_limits<double>::denorm_min(),
                         huge = std::numeric_limits<double>::max();
        CHECK(exact({}) == 0);
        CHECK(exact({1e308, 1, -1e308}) == 1);
        CHECK(exact({huge, huge, tiny, -huge, -huge}) == tiny);
        CHECK(exact({huge, huge}) == std::numeric_limits<double>::infinity());
        CHECK(exact({-tiny, -tiny}) == -2 * tiny);
        CHECK(exact({1, 0x1p-53}) == 1);                 // a tie, to the even one
        CHECK(exact({1, 0x1p-53, tiny}) == 1 + 0x1p-52); // just above it
        CHECK(exact({1 + 0x1p-52, 0x1p-53}) == 1 + 0x1p-51);
        CHECK(exact({-1, -0x1p-53, -tiny}) == -1 - 0x1p-52);
        CHECK(std::isnan(exact({1, std::numeric_limits<double>::infinity()})));
    }

    TEST_CASE("random sums agree with arithmetic of 2300 bits, in any order and grouping") {
        Random random(4, 0);
        for (int scene = 0; scene < 60; ++scene) {
            const int range = scene % 3 == 0 ? 1000 : scene % 3 == 1 ? 60 : 4; // of exponents
            std::vector<double> terms;
            for (int k = 0; k < 200; ++k) {
                const double size = 2 * random.uniform() - 1;
                terms.push_back(
                    std::ldexp(size, static_cast<int>(range * (2 * random.uniform() - 1))));
                if (k % 5 == 0) terms.push_back(-terms[terms.size() / 2]); // cancels most of it
            }
            const double expected = wide(terms);
            REQUIRE(exact(terms) == expected);
            for (std::size_t i = terms.size(); i > 1; --i)
                std::swap(terms[i - 1], terms[random.bits() % i]);
            REQUIRE(exact(terms) == expected);
            ExactSum parts;
            for (std::size_t first = 0; first < terms.size(); first += 50) {
                ExactSum part;
                for (std::size_t k = first; k < std::min(first + 50, terms.size()); ++k)
                    part.add(terms[k]);
                parts.add(part);
            }
            REQUIRE(parts.value() == expected);
        }
    }

    TEST_CASE("carries wait for a thousand million terms, and no longer") {
        ExactSum sum, block;
        for (int k = 0; k < 1 << 10; ++k) block.add(0x1.fffffffffffffp0);
        for (int k = 0; k < 21; ++k) { // 2^10 terms, doubled 21 times: 2^31
            const ExactSum same = block;
            block.add(same);
        }
        sum.add(block);
        CHECK(sum.value() == 0x1.fffffffffffffp31);
    }
}
