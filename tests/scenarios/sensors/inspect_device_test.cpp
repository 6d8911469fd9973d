#include "engine/random.hpp"
#include "scenarios/records/quality_control_report.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

using namespace bris;

namespace {

/// A rock at rest for a minute, at ten samples a second.
Recording still() {
    Recording r;
    Random random(3, 1);
    r.info.id = 4;
    r.info.sampling_rate = 10;
    for (int k = 0; k < 600; ++k) {
        r.time.push_back(0.1 * k);
        r.sequence.push_back(static_cast<std::uint64_t>(k));
        r.force.emplace_back(3e-3 * random.normal(), 3e-3 * random.normal(),
                             9.80665 + 3e-3 * random.normal());
        r.rate.emplace_back(3e-4 * random.normal(), 3e-4 * random.normal(), 3e-4 * random.normal());
    }
    return r;
}

/// The findings of one check, none of which refuses the sensor.
std::string found(const Recording& r, const std::string& check) {
    QualityControlLimits limits;
    limits.rest = 60;
    std::string text;
    for (const Finding& f : check_recordings({r}, Vec3(0, 0, -9.80665), limits)) {
        CHECK(f.kind == Finding::Kind::note);
        if (f.check == check) text += f.text + "\n";
    }
    return text;
}

void leave_out(Recording& r, std::size_t from, std::size_t to) {
    const auto cut = [&](auto& values) {
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(from),
                     values.begin() + static_cast<std::ptrdiff_t>(to));
    };
    cut(r.time);
    cut(r.sequence);
    cut(r.force);
    cut(r.rate);
}

} // namespace

TEST_SUITE("sensors/inspect_device") {
    TEST_CASE("the range and the drift of the temperature are reported, and impossible "
              "temperatures are queried") {
        Recording r = still();
        CHECK(found(r, "temperature").empty());
        for (std::size_t k = 0; k < r.size(); ++k)
            r.temperature.push_back(zero_celsius + 18 + 0.8 * static_cast<double>(k) / 599);
        CHECK(found(r, "temperature") == "18.0 to 18.8 C, +0.7 K from the beginning to the end\n");
        r.temperature[5] = std::nan("");
        CHECK(found(r, "numbers") == "1 of 600 samples have no number\n");
        for (double& kelvin : r.temperature) kelvin -= zero_celsius; // declared as K
        CHECK(found(r, "temperature").find("is temperature_unit right?") != std::string::npos);
    }

    TEST_CASE("a bias of the gyroscope at rest is reported if it depends on the temperature, and "
              "only then") {
        Recording r = still();
        for (std::size_t k = 0; k < r.size(); ++k)
            r.temperature.push_back(293 + 3 * std::sin(0.01 * static_cast<double>(k)));
        CHECK(found(r, "temperature").find("depends") == std::string::npos);
        for (std::size_t k = 0; k < r.size(); ++k) r.rate[k].y() -= 2e-4 * (r.temperature[k] - 293);
        INFO(found(r, "temperature"));
        const std::string text = found(r, "temperature"),
                          before = "the bias of gy at rest depends on it: ";
        REQUIRE(text.find(before) != std::string::npos);
        CHECK(std::abs(std::stod(text.substr(text.find(before) + before.size())) + 2e-4) <
              2e-5); // its standard error is 3e-4 / (2.1 sqrt(600)); the text has two digits
        CHECK(found(r, "temperature").find("gx") == std::string::npos);
        for (std::size_t k = 0; k < r.size(); ++k)
            r.temperature[k] =
                293 + 0.1 * (r.temperature[k] - 293); // a range below 1 K permits no conclusion
        CHECK(found(r, "temperature").find("depends") == std::string::npos);
    }

    TEST_CASE("a low battery is reported with the time from which it is low") {
        Recording r = still();
        for (std::size_t k = 0; k < r.size(); ++k)
            r.battery.push_back(3.9 - 0.001 * static_cast<double>(k));
        CHECK(found(r, "battery").empty()); // 3.301 V
        r.info.battery_low = 3.5;
        CHECK(found(r, "battery") == "low in 199 of 600 samples, the first at t = 40.1 s: expected "
                                     "at least 3.5 V, found 3.3\n");
        r.info.battery_low = 0;
        r.info.battery_unit = std::string("%");
        CHECK(found(r, "battery").find("expected at least 15 %, found 3.3") != std::string::npos);
    }

    TEST_CASE("samples that are missing by the sample counter are reported together with those "
              "that are missing by the times") {
        Recording r = still();
        CHECK(found(r, "count").empty());
        leave_out(r, 100, 112);
        leave_out(r, 300, 305);
        CHECK(found(r, "count") ==
              "17 samples are missing by the sample counter, in 2 gaps; 17 by the times\n");
        Recording flagged = r; // flagged by the sensor, not missing
        for (int k = 0; k < 12; ++k) flagged.flagged.push_back(10 + 0.1 * k);
        CHECK(found(flagged, "count") ==
              "5 samples are missing by the sample counter, in 1 gaps; 5 by the times\n");
        CHECK(found(flagged, "flags") ==
              "12 of 595 samples are left out because the sensor flags them, the first at t = 10 "
              "s\n");
    }

    TEST_CASE("a sample counter that continues across a gap of the times is reported as a "
              "contradiction, and a large contradiction refuses the clock") {
        Recording r = still();
        leave_out(r, 300, 305);
        for (std::size_t k = 0; k < r.size(); ++k) r.sequence[k] = k; // counts what was kept
        QualityControlLimits limits;
        limits.clock_drift = 0.05; // the slope of this clock is wrong by 0.01
        const auto findings = check_recordings({r}, Vec3(0, 0, -9.80665), limits);
        CHECK(accepted(findings, 4));
        CHECK(quality_control_report(findings, {r}).find("sensor 4: count: ") ==
              std::string::npos); // within the limit of the drift
        CHECK_FALSE(accepted(check_recordings({r}, Vec3(0, 0, -9.80665)), 4));
        CHECK(quality_control_report(check_recordings({r}, Vec3(0, 0, -9.80665)), {r})
                  .find("0 samples are missing by the sample counter, in 0 gaps; 5 by the times: "
                        "clock, counter or sampling_rate is wrong\n") != std::string::npos);
    }
}
