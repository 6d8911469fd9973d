#include "scenarios/recordings/device_channels.hpp"

namespace bris {

const std::vector<DeviceChannel>& device_channels() {
    static const std::vector<DeviceChannel> all{
        {.column = "temp",
         .dataset = "temperature",
         .values = &Recording::temperature,
         .unit = &SensorInfo::temperature_unit,
         .units = {{"K"}, {"C", 1, zero_celsius}, {"F", 1 / 1.8, zero_celsius - 32 / 1.8}},
         .from_file = &SensorInfo::temperature_of,
         .to_file = &SensorInfo::recorded_temperature},
        {.column = "batt",
         .dataset = "battery",
         .values = &Recording::battery,
         .unit = &SensorInfo::battery_unit,
         .units = {{"V"}, {"mV", 1e-3}, {"%"}}},
    };
    return all;
}

} // namespace bris
