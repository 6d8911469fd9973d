#include "tests/scenarios/sensors/example_recordings.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// The example without the attitudes of another means of tracking.
std::vector<Recording> of_inertia(const std::string& pressure) {
    auto all = example_recordings(pressure);
    for (Recording& r : all) r.attitude.clear();
    return all;
}

} // namespace

TEST_SUITE("sensors/compare_turns") {
    TEST_CASE("gravity agrees with the rates of the example, and refuses those of one sensor with "
              "the opposite sign") {
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"}) {
            const auto all = of_inertia(pressure);
            for (std::size_t s = 0; s < all.size(); ++s) {
                CHECK(refusals(all, all[s].info.id).empty());
                auto one = all;
                for (Vec3& w : one[s].rate) w = -w;
                CHECK(has(refusals(one, one[s].info.id), "rate: expected the rates to cause the "
                                                         "tilt that gravity shows"));
            }
        }
    }

    TEST_CASE("rates of all sensors with exchanged or reversed axes are refused, and the right "
              "assignment is named, also of sensors that are mounted askew") {
        for (const bool askew : {false, true}) {
            auto all = of_inertia("110kPa");
            for (Recording& r : all) {
                const Quat mounting = Quat(0.5, 0.5, 0.5, askew ? 0.5 : -0.5);
                r.info.mounting_w = mounting.w();
                r.info.mounting_x = mounting.x();
                r.info.mounting_y = mounting.y();
                r.info.mounting_z = mounting.z();
                for (Vec3& w : r.rate) {
                    const Vec3 sensor = mounting.conjugate() * w;
                    w = mounting * Vec3(sensor.y(), sensor.x(), -sensor.z());
                }
            }
            for (const Recording& r : all)
                CHECK(has(refusals(all, r.info.id), "if gx gy gz were gy gx -gz"));
        }
    }

    TEST_CASE("rates that show nothing but noise are not refused") {
        auto all = of_inertia("165kPa");
        for (Recording& r : all)
            for (std::size_t k = 5; k < r.size(); ++k) r.rate[k] = r.rate[k % 5];
        for (const Recording& r : all) CHECK(refusals(all, r.info.id).empty());
    }

    TEST_CASE("two rocks of a test at the same place are refused") {
        auto all = of_inertia("55kPa");
        all[1].info.x = all[0].info.x;
        all[1].info.y = all[0].info.y;
        all[1].info.z = all[0].info.z + 1e-3;
        CHECK(has(refusals(all, 1), "position: expected a rock at a place of its own, found it at "
                                    "that of sensor 2"));
        CHECK(has(refusals(all, 2), "position: "));
        CHECK(refusals(all, 3).empty());
    }
}
