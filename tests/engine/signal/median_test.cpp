#include "engine/random.hpp"
#include "engine/signal/median.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("engine/signal/median") {
    TEST_CASE("up to half of the values can be wrong before the median is") {
        CHECK(median(std::vector<double>{3, 1e9, 2, 1, -1e9}) == 2);
        CHECK(median(std::vector<double>{2, 1}) == 2);
        CHECK(median(std::vector<Vec3>{Vec3(1, 5, 0), Vec3(2, 1e9, 1), Vec3(1e9, 4, 2)}) ==
              Vec3(2, 5, 1));
    }

    TEST_CASE("the median of absolute values gives the standard deviation of normal numbers") {
        Random random(1, 1);
        std::vector<double> sizes;
        for (int k = 0; k < 100000; ++k) sizes.push_back(std::abs(0.3 * random.normal()));
        // 4 standard errors of 1.17/sqrt(n)
        CHECK(deviation_of_median(median(sizes)) == about(0.3).epsilon(0.015));
    }
}
