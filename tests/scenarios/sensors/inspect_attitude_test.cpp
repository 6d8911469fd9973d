#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "tests/scenarios/sensors/example_recordings.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// The refusals of the third sensor after its attitudes are changed.
std::string changed(auto&& change) {
    auto all = example_recordings("55kPa");
    for (Quat& q : all[2].attitude) q = change(q);
    return refusals(all, 3);
}

/// The same test with body axes of each rock that are the world axes at the start.
std::vector<Recording> begun_upright() {
    auto all = example_recordings("55kPa");
    for (Recording& r : all) {
        const Quat start = r.info.attitude();
        r.info.set_pose(r.info.position(), Quat::Identity());
        for (Quat& q : r.attitude) q = q * start.conjugate();
        for (Vec3& f : r.force) f = start * f;
        for (Vec3& w : r.rate) w = start * w;
    }
    return all;
}

} // namespace

TEST_SUITE("sensors/inspect_attitude") {
    TEST_CASE("quaternions of norm 0, or any other norm than 1, are refused") {
        CHECK(has(changed([](const Quat&) { return Quat(0, 0, 0, 0); }),
                  "attitude: expected unit quaternions, found 85 that are not, the first with norm "
                  "0"));
        CHECK(has(changed([](const Quat& q) { return Quat(1.01 * q.coeffs()); }), "norm 1.01"));
        CHECK(
            changed([](const Quat& q) { return Quat(-q.coeffs()); }).empty()); // the same attitude
    }

    TEST_CASE("attitudes from the world to the body, or with components in another order, are "
              "refused because they contradict the metadata") {
        CHECK(has(changed([](const Quat& q) { return q.conjugate(); }),
                  "seems to lead from the world to the body"));
        CHECK(has(changed([](const Quat& q) { return Quat(q.x(), q.y(), q.z(), q.w()); }),
                  "in the order x y z w"));
        CHECK(has(changed([](const Quat& q) { return Quat(q.x(), q.w(), q.y(), q.z()); }),
                  "attitude: at rest: expected"));
    }

    TEST_CASE("an attitude that is stuck while the rock rotates is refused") {
        auto all = example_recordings("55kPa");
        std::fill(all[2].attitude.begin() + 20, all[2].attitude.end(), all[2].attitude[20]);
        CHECK(has(refusals(all, 3), "stuck: attitude: expected noise, found the same value"));
    }

    TEST_CASE("an inverse attitude of a rock that starts upright is detected by gravity and by the "
              "angular rates once the rock has rotated") {
        auto all = begun_upright();
        for (const Recording& r : all) CHECK(refusals(all, r.info.id).empty());
        for (std::size_t s = 0; s < all.size(); ++s) {
            auto one = all;
            for (Quat& q : one[s].attitude) q = q.conjugate();
            CHECK(has(refusals(one, static_cast<unsigned>(s + 1)),
                      "attitude: inconsistent with gravity"));
        }
        for (Recording& r : all) {
            r.force.clear(); // the rates alone
            for (Quat& q : r.attitude) q = q.conjugate();
        }
        CHECK(std::ranges::count_if(all, [&](const Recording& r) {
                  return has(refusals(all, r.info.id),
                             "attitude: inconsistent with the angular rates");
              }) >= 7);
    }

    TEST_CASE("an attitude that does not rotate, although it has noise, contradicts gravity as "
              "soon as the rock has tilted") {
        auto all = example_recordings("55kPa");
        Random random(2, 1);
        for (Recording& r : all)
            for (Quat& q : r.attitude)
                q = exponential_map(2e-3 *
                                    Vec3(random.normal(), random.normal(), random.normal())) *
                    r.info.attitude();
        const auto refused = std::ranges::count_if(all, [&](const Recording& r) {
            return has(refusals(all, r.info.id), "attitude: inconsistent with gravity");
        });
        CHECK(refused >= 9); // one hardly tilts
    }

    TEST_CASE("attitudes with far more noise than declared are refused, a single outlier is "
              "not") {
        auto all = example_recordings("55kPa");
        all[2].attitude[40] = exponential_map(Vec3(0.5, 0, 0)) * all[2].attitude[40];
        CHECK(refusals(all, 3).empty());
        Random random(1, 1);
        for (Quat& q : all[2].attitude)
            q = exponential_map(0.04 * Vec3(random.normal(), random.normal(), random.normal())) * q;
        CHECK(has(refusals(all, 3), "noise: attitude at rest: declared 2 mrad"));
        CHECK(has(refusals(all, 3), "noise: attitude from sample to sample: declared 2 mrad"));
    }

    TEST_CASE("angular rates in other units than declared are detected by their bias at rest, or "
              "by the rotation of the attitude") {
        auto all = example_recordings("55kPa");
        for (Recording& r : all)
            for (Vec3& w : r.rate) w *= 180 / pi;
        const auto reported = [&](const std::string& what) {
            return std::ranges::count_if(
                all, [&](const Recording& r) { return has(refusals(all, r.info.id), what); });
        };
        CHECK(reported("rate: at rest: expected at most 0.014 rad/s") == 10);
        CHECK(reported("times as much: they seem to be in deg/s") >= 7);
        for (Recording& r : all)
            for (Vec3& w : r.rate) w *= std::pow(pi / 180, 2);
        CHECK(reported("rate: at rest") == 0);
        CHECK(reported("times as much: they seem to be in rad/s, not in deg/s") >= 7);
    }

    TEST_CASE("sparse single samples of the angular rate, between which a rock slips, are not "
              "refused") {
        auto all = example_recordings("55kPa");
        for (Recording& r : all)
            for (std::size_t k = 5; k < r.size(); ++k) r.rate[k] = r.rate[k % 5];
        for (const Recording& r : all) CHECK(refusals(all, r.info.id).empty());
    }
}
