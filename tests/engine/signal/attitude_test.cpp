#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("engine/signal/attitude") {
    TEST_CASE("the shortest rotation leads from one direction to another about the perpendicular "
              "to both") {
        Random random(5, 1);
        for (int k = 0; k < 100; ++k) {
            const Vec3 from = 3 * random.direction(), to = 0.2 * random.direction();
            const Quat q = shortest_rotation(from, to);
            CHECK(std::abs(q.norm() - 1) < 1e-15 * 4);
            CHECK((q * from.normalized() - to.normalized()).norm() < 1e-14);
            CHECK(std::abs(q.vec().dot(from)) < 1e-14);
            CHECK(q.w() >= 0);
        }
        CHECK(shortest_rotation(Vec3(0, 0, 2), Vec3(0, 0, 1)).coeffs() ==
              Quat::Identity().coeffs());
    }

    TEST_CASE(
        "the shortest rotation between opposite vectors is half a turn about a perpendicular") {
        for (const Vec3& from : {Vec3(0, 0, 1), Vec3(1, 2, -3), Vec3(0, -1, 0)}) {
            const Quat q = shortest_rotation(from, -0.5 * from);
            CHECK(q.w() == 0);
            CHECK(std::abs(q.norm() - 1) < 1e-15 * 4);
            CHECK(std::abs(q.vec().dot(from)) < 1e-14);
        }
    }
}
