#pragma once

#include "engine/options.hpp"
#include "scenarios/sensors/sensor_info.hpp"

#include <array>
#include <string>
#include <vector>

namespace bris {

// Apart from SensorInfo, because it is only needed where metadata are read or written.

void SensorInfo::declare_options(auto& option) {
    using Choices = std::vector<std::string>; // visitors may deduce it
    const auto quaternion = [&](const std::string& name, std::array<double*, 4> wxyz,
                                const std::string& what) {
        for (std::size_t i = 0; i < wxyz.size(); ++i) {
            const std::string part(1, "wxyz"[i]);
            option(name + part, *wxyz[i], "", what + ": quaternion, " + part + ".", within(-1, 1));
        }
    };
    option("id", id, "", "Number of the sensor in the recordings.");
    const Range in_reach = within(-100, 100), in_rock = within(-1, 1); // m; not in mm
    option("x", x, "m", "Coordinate x of the centre of the rock at the start.", in_reach);
    option("y", y, "m", "Coordinate y of the centre of the rock at the start.", in_reach);
    option("z", z, "m", "Coordinate z (upwards) of the centre of the rock at the start.", in_reach);
    quaternion("q", {&qw, &qx, &qy, &qz}, "Attitude at the start, body to world");
    option("placed_x_over_radius", placed_x, "",
           "Coordinate x, over the radius of the specimen, where the rock was placed when the "
           "specimen was built. All names that begin with placed_ may be omitted: then the rock "
           "was placed as it is at the start.");
    option("placed_y_over_radius", placed_y, "", "Coordinate y, over the radius, likewise.");
    option("placed_z_over_height", placed_z, "",
           "Coordinate z, over the height of the specimen, likewise.");
    quaternion("placed_q", {&placed_qw, &placed_qx, &placed_qy, &placed_qz},
               "Attitude in which it was placed");
    option("position_deviation", position_deviation, "m",
           "Standard deviation of the position at the start.", above(0));
    option("attitude_deviation", attitude_deviation, "degrees",
           "Standard deviation of the attitude at the start.", above(0));
    option("arm_x", arm_x, "m", "Lever arm from the centre to the sensor, body axes: x.", in_rock);
    option("arm_y", arm_y, "m", "Lever arm from the centre to the sensor, body axes: y.", in_rock);
    option("arm_z", arm_z, "m", "Lever arm from the centre to the sensor, body axes: z.", in_rock);
    quaternion("mounting_", {&mounting_w, &mounting_x, &mounting_y, &mounting_z},
               "Rotation from sensor axes to body axes");
    option("force_unit", force_unit, "", "Unit of ax ay az.", Choices{"m/s2", "g"});
    option("rate_unit", rate_unit, "", "Unit of gx gy gz.", Choices{"rad/s", "deg/s"});
    option("sampling_rate", sampling_rate, "Hz", "Nominal sampling rate.", above(0, 1e6));
    option("force_range", force_range, "m/s2", "Largest specific force that the sensor measures.",
           above(0));
    option("rate_range", rate_range, "rad/s", "Largest angular rate that the sensor measures.",
           above(0));
    option("force_noise", force_noise, "m/s2/sqrt(Hz)", "Noise density of the accelerometer.",
           at_least(0));
    option("rate_noise", rate_noise, "rad/s/sqrt(Hz)", "Noise density of the gyroscope.",
           at_least(0));
    option("force_bias", force_bias, "m/s2",
           "Standard deviation of the accelerometer bias after calibration.", at_least(0));
    option("rate_bias", rate_bias, "rad/s",
           "Standard deviation of the gyroscope bias after calibration.", at_least(0));
    option("displacement_noise", displacement_noise, "m", "Standard deviation of ux uy uz.",
           above(0));
    option("attitude_noise", attitude_noise, "rad",
           "Standard deviation of the attitude qw qx qy qz.", above(0));
    option("clock_offset", clock_offset, "s",
           "Lead of the clock of the sensor over that of the test machine.");
    option("clock_offset_deviation", clock_offset_deviation, "s",
           "Standard deviation of clock_offset.", at_least(0));
    option("field_unit", field_unit, "", "Unit of mx my mz.",
           Choices{"uT", "nT", "mT", "T", "G", "mG"});
    option("temperature_unit", temperature_unit, "", "Unit of temp.", Choices{"C", "K", "F"});
    option("battery_unit", battery_unit, "", "Unit of batt.", Choices{"V", "%"});
    option("field_noise", field_noise, "uT", "Standard deviation of a sample of mx my mz.",
           above(0));
    option("field_bias", field_bias, "uT",
           "Standard deviation of the magnetometer bias after calibration.", at_least(0));
    option("battery_low", battery_low, "V or %",
           "Level below which the battery is low; 0: 3.3 V or 15 %.", at_least(0));
    option("flags_ignored", flags_ignored, "", "Bits of flags that do not reject a sample.");
}

} // namespace bris
