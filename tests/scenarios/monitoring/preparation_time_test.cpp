#include "scenarios/monitoring/preparation_time.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

using namespace bris;

namespace {

void wait(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

} // namespace

TEST_SUITE("monitoring/preparation_time") {
    TEST_CASE("the time left follows the speed of the preparation and falls with its parts") {
        std::vector<std::pair<std::string, double>> told;
        PreparationTime time(
            [&](const std::string& doing, double left) { told.emplace_back(doing, left); }, 2,
            0.002, 0.01);
        time.specimen_reached({"filling", 0, "rocks at 30 % of their size"});
        REQUIRE(told.size() == 1);
        CHECK(told[0].first == "making the specimen: filling, rocks at 30 % of their size");
        CHECK(std::isnan(told[0].second)); // nothing is done
        wait(250);
        time.specimen_reached({"filling", 0.5, ""});
        REQUIRE(told.size() == 2);
        const double at_first = told[1].second;
        CHECK(at_first > 0.5); // half of the filling took a quarter of a second
        wait(250);
        time.specimen_reached({"preparation", 0.9, ""});
        wait(250);
        time.specimen_reached({"preparation", -1, "trial consolidation, pressure"});
        wait(250);
        time.member_reached(0, {"55 kPa shear", 0.1, ""});
        CHECK(told.back().first.starts_with("preparing 2 ensemble members: 55 kPa shear"));
        time.member_reached(1, {"55 kPa shear", 0.1, ""});
        wait(250);
        time.member_reached(0, {"55 kPa shear", 0.19, ""});
        CHECK(told.back().second < 0.5 * at_first);
        CHECK(told.back().second >= 0);
        const std::size_t count = told.size();
        time.end();
        wait(250);
        time.member_reached(0, {"55 kPa shear", 0.9, ""});
        CHECK(told.size() == count);
    }
}
