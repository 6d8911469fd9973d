#include "tests/verification/surface_integral.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// The k-th of `points` directions that are evenly spread on a sphere: a spiral by the golden
/// angle.
Vec3 direction(int k, int points) {
    const double z = 1 - (2 * k + 1.0) / points, around = std::sqrt(1 - z * z);
    const double angle = k * pi * (3 - std::sqrt(5.0));
    return {around * std::cos(angle), around * std::sin(angle), z};
}

} // namespace

MassProperties surface_integrals(std::span<const Ball> balls, int points) {
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero(); // integral of x xᵀ
    for (const Ball& ball : balls) {
        const double area = 4 * pi * ball.radius * ball.radius / points;
        for (int k = 0; k < points; ++k) {
            const Vec3 normal = direction(k, points), x = ball.centre + ball.radius * normal;
            const bool covered = std::ranges::any_of(balls, [&](const Ball& other) {
                return &other != &ball &&
                       (x - other.centre).squaredNorm() < other.radius * other.radius;
            });
            if (covered) continue;
            // the divergence of x f(x) is (3 + n) f(x) if f is of degree n
            const double flux = area * x.dot(normal);
            volume += flux / 3;
            first += flux / 4 * x;
            second += flux / 5 * x * x.transpose();
        }
    }
    MassProperties result;
    result.volume = volume;
    result.centre = first / volume;
    second -= volume * result.centre * result.centre.transpose();
    result.inertia = second.trace() * Mat3::Identity() - second;
    return result;
}

} // namespace bris
