#include "engine/lane_math.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

using namespace bris;

namespace {

// the last group is short
constexpr std::size_t many = 2 * static_cast<std::size_t>(lane_count) + 3;

Vec3 vector_in(Random& random, double scale) {
    return scale * random.uniform(0, 1) * random.direction();
}

std::vector<Vec3> vectors(std::uint64_t seed, double scale) {
    Random random(seed, 0);
    std::vector<Vec3> all(many);
    for (Vec3& v : all) v = vector_in(random, scale);
    return all;
}

} // namespace

TEST_SUITE("engine/lane_math") {
    TEST_CASE("columns are loaded and stored row by row, without touching rows beyond the last") {
        const auto from = vectors(1, 1);
        auto to = vectors(2, 1);
        const Vec3 kept = to[many - 1];
        for_lane_rows(0, many - 1,
                      [&](LaneRows rows) { store(to.data(), rows, load(from.data(), rows)); });
        for (std::size_t k = 0; k + 1 < many; ++k) CHECK(to[k] == from[k]);
        CHECK(to[many - 1] == kept);

        std::vector<Quat> turns(many), copies(many, Quat(Quat::Identity()));
        std::vector<double> norms(many);
        for (std::size_t k = 0; k < many; ++k) turns[k] = exponential_map(from[k]);
        for_lane_rows(0, many, [&](LaneRows rows) {
            const QuatLanes q = load(turns.data(), rows);
            store(copies.data(), rows, q);
            store(norms.data(), rows, squared_norm(q));
        });
        for (std::size_t k = 0; k < many; ++k) {
            CHECK(copies[k].coeffs() == turns[k].coeffs());
            CHECK(norms[k] == about(1).epsilon(1e-15));
        }
    }

    TEST_CASE("equal() finds the rows that hold a value") {
        std::vector<std::uint32_t> kinds(many);
        for (std::uint32_t k = 0; k < many; ++k) kinds[k] = k % 3;
        for_lane_rows(0, many, [&](LaneRows rows) {
            const unsigned found = bits(equal(kinds.data(), rows, 2));
            for (int k = 0; k < rows.count; ++k)
                CHECK(((found >> k) & 1) == (kinds[rows.first + static_cast<Row>(k)] == 2));
        });
    }

    TEST_CASE("rotations agree with those of a single body and have the same bits in every lane") {
        const auto angles = vectors(3, 20), points = vectors(4, 1);
        std::vector<Quat> turns(many), alone(many);
        std::vector<Vec3> world(many), back(many);
        for_lane_rows(0, many, [&](LaneRows rows) {
            const QuatLanes q = exponential_map(load(angles.data(), rows));
            const AxesLanes axes = axes_of(q);
            store(turns.data(), rows, q);
            store(world.data(), rows, to_world(axes, load(points.data(), rows)));
            store(back.data(), rows, to_body(axes, load(world.data(), rows)));
        });
        for (std::size_t k = 0; k < many; ++k) {
            const Row row = static_cast<Row>(k);
            store(alone.data(), LaneRows{row, 1},
                  exponential_map(load(angles.data(), LaneRows{row, 1})));
            CHECK(alone[k].coeffs() == turns[k].coeffs());
            CHECK((turns[k].coeffs() - exponential_map(angles[k]).coeffs()).norm() < 1e-14);
            CHECK((world[k] - turns[k] * points[k]).norm() < 1e-14);
            CHECK((back[k] - points[k]).norm() < 1e-14);
        }
    }

    TEST_CASE("an infinite rotation angle terminates and gives a quaternion that is not finite") {
        const double infinite = std::numeric_limits<double>::infinity();
        std::vector<Vec3> angle{Vec3(infinite, 0, 0)};
        std::vector<Quat> q(1);
        store(q.data(), LaneRows{0, 1}, exponential_map(load(angle.data(), LaneRows{0, 1})));
        CHECK(!q[0].coeffs().allFinite());
    }
}
