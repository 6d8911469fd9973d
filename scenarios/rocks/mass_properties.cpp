#include "scenarios/rocks/mass_properties.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/dimensions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bris {
namespace {

/// Moments of a solid up to order two about the origin of the frame.
struct Moments {
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero(); // integral of x xᵀ

    void add_column(double x, double y, double low, double high) {
        const double length = high - low;
        const double z1 = 0.5 * (high * high - low * low);
        const double z2 = (high * high * high - low * low * low) / 3;
        volume += length;
        first += Vec3(x * length, y * length, z1);
        second(0, 0) += x * x * length;
        second(0, 1) += x * y * length;
        second(1, 1) += y * y * length;
        second(0, 2) += x * z1;
        second(1, 2) += y * z1;
        second(2, 2) += z2;
    }
};

struct Interval {
    double low, high;
};

/// Intersection of a sphere with a plane of constant x: a disc in y, z.
struct Disc {
    double y, z, radius_squared;
};

void add_row(std::span<const Disc> discs, double x, double y, std::vector<Interval>& spans,
             Moments& moments) {
    spans.clear();
    for (const Disc& disc : discs) {
        const double half_squared = disc.radius_squared - (y - disc.y) * (y - disc.y);
        if (half_squared <= 0) continue;
        const double half = std::sqrt(half_squared);
        spans.push_back({disc.z - half, disc.z + half});
    }
    if (spans.empty()) return;
    std::sort(spans.begin(), spans.end(),
              [](const Interval& a, const Interval& b) { return a.low < b.low; });
    Interval merged = spans.front();
    for (const Interval& span : spans) {
        if (span.low > merged.high) {
            moments.add_column(x, y, merged.low, merged.high);
            merged = span;
        }
        merged.high = std::max(merged.high, span.high);
    }
    moments.add_column(x, y, merged.low, merged.high);
}

MassProperties from_moments(const Moments& moments, const Vec3& origin) {
    MassProperties result;
    result.volume = moments.volume;
    const Vec3 centre = moments.first / moments.volume;
    Mat3 second = moments.second;
    second(1, 0) = second(0, 1);
    second(2, 0) = second(0, 2);
    second(2, 1) = second(1, 2);
    second -= moments.volume * centre * centre.transpose();
    result.inertia = second.trace() * Mat3::Identity() - second;
    result.centre = origin + centre;
    return result;
}

struct Pose {
    double side;
    Quat rotation;
};

double square_side(std::span<const Ball> balls, const Quat& rotation) {
    return std::max(width(balls, rotation * Vec3::UnitX()), width(balls, rotation * Vec3::UnitY()));
}

/// Random search with a decreasing step: the side is not smooth, so descent along axes would stall.
double refine_side(std::span<const Ball> balls, Pose pose, Random& random) {
    for (double step = 0.1; step > 2e-5; step *= 0.6)
        for (int trial = 0; trial < 24; ++trial) {
            const Quat turned = exponential_map(step * random.direction()) * pose.rotation;
            const double side = square_side(balls, turned);
            if (side < pose.side) pose = {side, turned};
        }
    return pose.side;
}

} // namespace

MassProperties union_properties(std::span<const Ball> balls, int columns) {
    require(!balls.empty(), "mass properties: expected at least one sphere, found none");
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Ball& ball : balls) {
        require(ball.radius > 0 && std::isfinite(ball.radius) && ball.centre.allFinite(),
                "mass properties: expected positive finite radii and finite centres");
        low = low.cwiseMin(ball.centre - Vec3::Constant(ball.radius));
        high = high.cwiseMax(ball.centre + Vec3::Constant(ball.radius));
    }
    // about the middle of the box, so that a clump far from the origin loses no digits
    const Vec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
    const double dx = 2 * half.x() / columns, dy = 2 * half.y() / columns;
    Moments moments;
    std::vector<Disc> discs;
    std::vector<Interval> spans;
    for (int i = 0; i < columns; ++i) {
        const double x = -half.x() + (i + 0.5) * dx;
        discs.clear();
        for (const Ball& ball : balls) {
            const Vec3 centre = ball.centre - middle;
            const double squared = ball.radius * ball.radius - (x - centre.x()) * (x - centre.x());
            if (squared > 0) discs.push_back({centre.y(), centre.z(), squared});
        }
        for (int j = 0; j < columns; ++j)
            add_row(discs, x, -half.y() + (j + 0.5) * dy, spans, moments);
    }
    moments.volume *= dx * dy;
    moments.first *= dx * dy;
    moments.second *= dx * dy;
    return from_moments(moments, middle);
}

MassProperties union_properties(std::span<const Ball> balls, double tolerance) {
    MassProperties coarse = union_properties(balls, 200);
    for (int columns = 400; columns <= 6400; columns *= 2) {
        const MassProperties fine = union_properties(balls, columns);
        const double size = std::cbrt(fine.volume);
        const bool settled =
            std::abs(fine.volume - coarse.volume) < tolerance * fine.volume &&
            (fine.centre - coarse.centre).norm() < tolerance * size &&
            (fine.inertia - coarse.inertia).norm() < tolerance * fine.inertia.norm();
        if (settled) return fine;
        coarse = fine;
    }
    throw InputError(
        "mass properties: expected a body whose volume 6400 x 6400 columns show to the tolerance, "
        "found one that is too slender");
}

PrincipalAxes principal_axes(const Mat3& inertia) {
    Mat3 tensor = inertia, axes = Mat3::Identity();
    const double negligible = 1e-7 * inertia.trace();
    for (int sweep = 0; sweep < 30; ++sweep) {
        bool diagonal = true;
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (std::abs(tensor(p, q)) <= (sweep == 0 ? negligible : 1e-9 * negligible))
                    continue;
                diagonal = false;
                const double theta = (tensor(q, q) - tensor(p, p)) / (2 * tensor(p, q));
                const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::hypot(t, 1.0), s = t * c;
                Mat3 turn = Mat3::Identity();
                turn(p, p) = turn(q, q) = c;
                turn(p, q) = s;
                turn(q, p) = -s;
                tensor = (turn.transpose() * tensor * turn).eval();
                axes = (axes * turn).eval();
            }
        if (diagonal) break;
    }
    return {tensor.diagonal(), axes};
}

double sieve_size(std::span<const Ball> balls) {
    constexpr std::size_t kept = 8;
    constexpr int starts = 3000;
    std::vector<Pose> poses;
    Random random(1, 0); // a fixed seed, so that the result depends on the shape alone
    for (int k = 0; k < starts; ++k) {
        const Quat rotation = random.rotation();
        poses.push_back({square_side(balls, rotation), rotation});
    }
    std::partial_sort(poses.begin(), poses.begin() + kept, poses.end(),
                      [](const Pose& a, const Pose& b) { return a.side < b.side; });
    double best = poses.front().side;
    for (std::size_t k = 0; k < kept; ++k)
        best = std::min(best, refine_side(balls, poses[k], random));
    // the given axes too, so that a box in its own axes is exact
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
        best = std::min(best, std::max(width(balls, u), width(balls, v)));
    }
    return best;
}

Clump make_clump(const std::string& name, std::span<const Ball> balls) {
    const MassProperties mass = union_properties(balls);
    const PrincipalAxes principal = principal_axes(mass.inertia);
    Clump clump;
    clump.name = name;
    clump.volume = mass.volume;
    clump.inertia = principal.moments;
    for (const Ball& ball : balls) {
        const Vec3 centre = principal.axes.transpose() * (ball.centre - mass.centre);
        clump.balls.push_back({centre, ball.radius});
        clump.bounding_radius = std::max(clump.bounding_radius, centre.norm() + ball.radius);
    }
    clump.sieve = sieve_size(clump.balls);
    return clump;
}

} // namespace bris
