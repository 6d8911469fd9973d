#pragma once

#include "engine/math.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Position and attitude of a sensor rock before the test. The axis of the specimen is z; its lower
/// platen is at z = 0.
struct SmartRockPose {
    Vec3 position; ///< m, of the centre of mass, in a specimen of the wanted height
    Quat orientation;
};

/// Mould in which the sensor rocks are placed, and bounding radius of one of them, m.
struct SensorRoom {
    double radius, height, bounding_radius;
};

/// Number of the ten sensor rocks of smart_rock_poses that fit into a mould: 10, 7 (without those
/// in the centre) or 3 (without those beside the membrane).
std::size_t smart_rock_count(const SensorRoom& room);

/// Places ten sensor rocks at three heights: at a quarter of the height one in the
/// centre and one beside the membrane; at one half and three quarters of the height one in the
/// centre and three beside the membrane, 120 degrees apart. `count`: 10, 7 or 3 (smart_rock_count).
/// The orientations are drawn from the seed.
std::vector<SmartRockPose> smart_rock_poses(const SensorRoom& room, std::uint64_t seed,
                                            std::size_t count);

/// A pose by a file, before the size of the mould is known.
struct GivenPose {
    Vec3 position; ///< relative to the radius (x, y) and the height (z) of the mould, or m
    Quat orientation;
    bool is_relative = true;
    std::string where; ///< file and line, or sensor, for messages
};

/// Reads poses from a CSV file with a row for each sensor rock: x_over_radius, y_over_radius,
/// z_over_height, qw, qx, qy, qz (a unit quaternion, principal axes to world). Throws InputError.
std::vector<GivenPose> read_sensor_poses(const std::filesystem::path& csv);

/// Why sensor rocks cannot be placed in a mould: outside it, too close to one before it, or no unit
/// quaternion. A text for each pose; empty: it can be placed.
std::vector<std::string> placing_problems(const SensorRoom& room,
                                          const std::vector<GivenPose>& given);

/// Places sensor rocks in a mould. Throws InputError with the first of the placing_problems.
std::vector<SmartRockPose> placed_in(const SensorRoom& room, const std::vector<GivenPose>& given);

} // namespace bris
