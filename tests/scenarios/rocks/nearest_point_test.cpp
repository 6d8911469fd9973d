#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/nearest_point.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

using namespace bris;

TEST_SUITE("rocks/nearest_point") {
    TEST_CASE("the tree finds the same nearest distance as a comparison with all points") {
        Random random(4, 0);
        const auto somewhere = [&]() -> Vec3 {
            return random.uniform(0, 0.05) * random.direction();
        };
        std::vector<Vec3> points;
        for (int k = 0; k < 500; ++k) points.push_back(somewhere());
        points.push_back(points.front()); // a duplicate
        const NearestPoint nearest(points);
        for (int k = 0; k < 200; ++k) {
            const Vec3 position = somewhere();
            double least = std::numeric_limits<double>::infinity();
            for (const Vec3& p : points) least = std::min(least, (position - p).norm());
            CHECK(nearest.distance(position) == about(least).epsilon(1e-14));
        }
        CHECK(nearest.distance(points[7]) == 0);
        CHECK_THROWS_AS(NearestPoint({}), InputError);
    }
}
