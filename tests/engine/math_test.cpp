#include "engine/math.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("engine/math") {
    TEST_CASE("the exponential map agrees with the closed form for any angle") {
        Random random(3, 1);
        for (const double angle :
             {0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.5, 1.0, 3.0, pi, 10.0, 100.0, 1e4}) {
            for (int k = 0; k < 20; ++k) {
                const Vec3 axis = random.direction();
                const Quat q = exponential_map(angle * axis);
                CAPTURE(angle);
                // the angle is known to eps * angle; each of the log2(2 angle) squarings doubles
                // the error of about eps of the series
                const double tolerance = 1e-15 * (4 + 4 * angle);
                CHECK(std::abs(q.w() - std::cos(angle / 2)) <= tolerance);
                CHECK((q.vec() - std::sin(angle / 2) * axis).norm() <= tolerance);
            }
        }
    }

    TEST_CASE("the exponential map of the zero vector is exactly the identity") {
        const Quat q = exponential_map(Vec3::Zero());
        CHECK(q.w() == 1);
        CHECK(q.vec() == Vec3::Zero());
    }

    TEST_CASE("a rotation by a followed by one by b about the same axis is a rotation by a + b") {
        const Vec3 axis = Vec3(1, -2, 0.5).normalized();
        const Quat both = exponential_map(0.7 * axis) * exponential_map(1.9 * axis);
        CHECK((both.coeffs() - exponential_map(2.6 * axis).coeffs()).norm() < 1e-14);
    }
}
