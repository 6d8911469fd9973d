#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace bris {

/// What the title of a column says if it is an axis of an accelerometer or gyroscope.
struct AxisTitle {
    bool is_rate = false;   ///< an angular rate; otherwise an acceleration
    bool is_linear = false; ///< an acceleration from which gravity has been removed
    bool is_bare = false;   ///< only the axis is named: "x", "X-Axis"
    std::size_t axis = 0;   ///< 0 to 2
    unsigned number = 0;    ///< of the sensor, as in "ACC01_z" or "imu2 gyro x"; 0: none
    std::string unit_word;  ///< as written; "": not stated
};

/// Reads titles as they are written by many loggers, word by word: "Acceleration x (m/s^2)",
/// "Linear Acceleration x", "accX_g", "gyrX_dps", "ACC01_z [g]", "FreeAcc_X", "gFx", "x". Nothing
/// for titles that have no axis or are of something else, such as "Absolute acceleration".
std::optional<AxisTitle> axis_title(const std::string& title);

} // namespace bris
