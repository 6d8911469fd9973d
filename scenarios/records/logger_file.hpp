#pragma once

#include "scenarios/sensors/recording.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// What a user adds to what a logger's file says itself.
struct LoggerSettings {
    double rate = 0; ///< Hz, of each sensor; 0: by the times, or as the file states it
    /// Columns by number, counted from 1, or by title, with a unit where the file does not state
    /// the right one: "t=1 ms, id=2, ax=3 g, ay=4, az=-5, gx=6 deg/s". Empty: found by their titles
    /// or contents.
    std::string axes;
    std::filesystem::path columns; ///< a column map (column_map.hpp); empty: none
};

/// A logger's file as recordings.
struct LoggerFile {
    std::vector<Recording> recordings; ///< one for each sensor, in order of id, each with samples
    /// Whether accelerations contain gravity. Without it a constant standard gravity is added along
    /// z, or along the only axis that was recorded, because the mean direction of the force at rest
    /// is taken as vertical: vibration can be judged, the attitude cannot.
    bool has_gravity = true;
    bool is_absolute = false; ///< times are seconds since 1970; otherwise by the logger's own clock
    bool has_id = true;       ///< whether the file, its name or its folder's name gives the ids
    std::vector<std::string> notes; ///< what was assumed, added and left out, one sentence each
};

/// Lets the times of all recordings begin at 0 together. Returns what was their first time, s.
double begin_at_zero(std::vector<Recording>& recordings);

/// Reads a file of phyphox, Sensor Logger, Xsens or of any other logger that writes a table of
/// samples: accelerations, with or without angular rates, of one sensor or of several. Delimiter,
/// decimal sign, the line of names, which column is which, units and sampling rate are found in the
/// file; what it or the user states holds, and is compared with what the numbers show. Forces are
/// in m/s2, rates in rad/s, in the axes of the sensor; axes that were not recorded are 0. Damaged
/// rows, and times that repeat or go back, are left out and counted in the notes; more than one in
/// twenty is refused. Throws InputError with the file, the columns found and what to add;
/// OutputError if it cannot be read.
LoggerFile read_logger_file(const std::filesystem::path& file, const LoggerSettings& settings = {});

} // namespace bris
