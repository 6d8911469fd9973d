#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

using namespace bris;

namespace {

/// The 30 spheres of the reference quadrature: centres in an ellipsoid, drawn by a congruential
/// generator.
std::vector<Ball> reference_clump() {
    std::uint64_t state = 20260101;
    const auto uniform = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) * 0x1p-53;
    };
    std::vector<Ball> balls;
    while (balls.size() < 30) {
        const double x = 2 * uniform() - 1, y = 2 * uniform() - 1, z = 2 * uniform() - 1;
        if (x * x + y * y + z * z > 1) continue;
        balls.push_back({{0.7 * x, 0.525 * y, 0.385 * z}, 0.25 + 0.2 * uniform()});
    }
    return balls;
}

} // namespace

TEST_SUITE("rocks/mass_properties") {
    TEST_CASE("a single sphere has its exact volume and inertia wherever it is") {
        const std::vector<Ball> balls{{Vec3(10, -20, 5), 0.5}};
        const MassProperties mass = union_properties(balls);
        const double volume = 4 * pi / 3 * 0.125;
        // refinement stops when a doubling changes less than 1e-5; the remaining error is smaller
        CHECK(mass.volume == about(volume).epsilon(1e-5));
        for (int k = 0; k < 3; ++k)
            CHECK(mass.inertia(k, k) == about(0.4 * volume * 0.25).epsilon(1e-5));
        CHECK((mass.centre - balls[0].centre).norm() < 1e-9);
    }

    TEST_CASE("the overlap of two unit spheres one radius apart counts once") {
        const std::vector<Ball> balls{{Vec3(0, 0, -0.5), 1}, {Vec3(0, 0, 0.5), 1}};
        const MassProperties mass = union_properties(balls);
        CHECK(mass.volume == about(9 * pi / 4).epsilon(1e-5)); // 7.0685834706
        CHECK(mass.inertia(2, 2) == about(3.0041479750).epsilon(1e-5));
        CHECK(mass.inertia(0, 0) == about(5.2130803096).epsilon(1e-5));
    }

    TEST_CASE("mass properties of thirty overlapping spheres agree with an independent "
              "quadrature") {
        const std::vector<Ball> balls = reference_clump();
        REQUIRE(balls[29].radius == about(0.3491970854254921).epsilon(1e-12));
        const MassProperties mass = union_properties(balls);
        Vec3 moments = principal_axes(mass.inertia).moments;
        std::sort(moments.begin(), moments.end());
        // the reference has an error of 1e-6, the tolerance is 1e-5
        CHECK(mass.volume == about(2.05183007628935).epsilon(1e-5));
        CHECK(moments[0] == about(0.43984187194670005).epsilon(1e-5));
        CHECK(moments[1] == about(0.5918501957691908).epsilon(1e-5));
        CHECK(moments[2] == about(0.6331898178576105).epsilon(1e-5));
        CHECK((mass.centre - Vec3(0.022828962235, 0.061470865993, 0.017259660956)).norm() < 1e-5);
    }

    TEST_CASE("a rotated and translated clump keeps its volume and principal moments") {
        Random random(3, 0);
        std::vector<Ball> balls, moved;
        for (int k = 0; k < 8; ++k)
            balls.push_back({random.direction() * 0.5, random.uniform(0.3, 0.5)});
        const Quat turn = random.rotation();
        for (const Ball& ball : balls)
            moved.push_back({turn * ball.centre + Vec3(1, 2, 3), ball.radius});
        const Clump a = make_clump("a", balls), b = make_clump("b", moved);
        Vec3 left = a.inertia, right = b.inertia;
        std::sort(left.begin(), left.end());
        std::sort(right.begin(), right.end());
        CHECK(a.volume == about(b.volume).epsilon(2e-5));
        for (int k = 0; k < 3; ++k) CHECK(left[k] == about(right[k]).epsilon(2e-5));
        // the random search for the opening has an error of 1e-4 of the size in both
        CHECK(a.sieve == about(b.sieve).epsilon(5e-4));
    }

    TEST_CASE("a clump has its origin at the centre of mass and its axes along the principal "
              "axes") {
        const std::vector<Ball> balls{
            {Vec3(1, 1, 0), 1}, {Vec3(2, 2, 0), 1}, {Vec3(1.2, 1.2, 1), 0.7}};
        const Clump clump = make_clump("bent", balls);
        const MassProperties mass = union_properties(clump.balls);
        CHECK(mass.centre.norm() < 2e-5);
        const Mat3 diagonal = clump.inertia.asDiagonal();
        CHECK((mass.inertia - diagonal).norm() < 2e-5 * mass.inertia.norm());
        for (const Ball& ball : clump.balls)
            CHECK(ball.centre.norm() + ball.radius <= clump.bounding_radius + 1e-15);
    }

    TEST_CASE("scaling multiplies volume by the third and inertia by the fifth power of the "
              "factor") {
        const Clump one =
            make_clump("one", std::vector<Ball>{{Vec3(0, 0, 0), 1}, {Vec3(1, 0, 0), 1}});
        const Clump half = scaled(one, 0.5), direct = make_clump("direct", half.balls);
        CHECK(half.volume == about(direct.volume).epsilon(2e-5));
        CHECK(half.inertia.x() == about(direct.inertia.x()).epsilon(2e-5));
        CHECK(half.sieve == about(direct.sieve).epsilon(4e-4));
        CHECK(half.bounding_radius == about(0.5 * one.bounding_radius).epsilon(1e-15));
    }

    TEST_CASE("principal axes are right-handed, and unchanged if the solid does not define any") {
        Mat3 tensor;
        tensor << 2, 0.3, -0.1, 0.3, 3, 0.2, -0.1, 0.2, 4;
        const PrincipalAxes found = principal_axes(tensor);
        CHECK(found.axes.determinant() == about(1).epsilon(1e-14));
        const Mat3 back = found.axes * found.moments.asDiagonal() * found.axes.transpose();
        CHECK((back - tensor).norm() < 1e-13);
        CHECK(principal_axes(Mat3::Identity()).axes == Mat3(Mat3::Identity()));
    }

    TEST_CASE("the sieve size of a row of spheres is the width of the row") {
        // seen along the row the shape is a disc, which passes no opening below its diameter
        const std::vector<Ball> row{
            {Vec3(0, 0, 0), 0.5}, {Vec3(0.8, 0, 0), 0.5}, {Vec3(1.6, 0, 0), 0.5}};
        CHECK(sieve_size(row) == about(1).epsilon(1e-3));
        CHECK(sieve_size(row) >= 1);
    }

    TEST_CASE("an empty set of spheres and a radius that is not positive are refused") {
        CHECK_THROWS_AS(union_properties(std::vector<Ball>{}), InputError);
        CHECK_THROWS_AS(union_properties(std::vector<Ball>{{Vec3(0, 0, 0), 0}}), InputError);
        CHECK_THROWS_AS(union_properties(std::vector<Ball>{{Vec3(0, 0, 0), NAN}}), InputError);
    }
}
