#pragma once

#include "engine/math.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// A sensor rock's place and attitude before the test. The axis of the specimen is z, its lower
/// platen at z = 0.
struct SmartRockPose {
    Vec3 position; ///< m, of the centre of mass, in a specimen of the wanted height
    Quat orientation;
};

/// The mould that the sensor rocks stand in, and the bounding radius (m) of one of them.
struct SensorRoom {
    double radius, height, bounding_radius;
};

/// How many of the ten sensor rocks of smart_rock_poses a mould has room for: 10, or 7 without
/// those in the centre, or 3 without those beside the membrane.
std::size_t smart_rock_count(const SensorRoom& room);

/// Ten sensor rocks at the interfaces of four lifts (inventory T4): at a quarter of the height one
/// in the centre and one beside the membrane; at the half and three quarters one in the centre and
/// three beside the membrane at 120 degrees; or 7 or 3 of them. Orientations are drawn from the
/// seed.
std::vector<SmartRockPose> smart_rock_poses(const SensorRoom& room, std::uint64_t seed,
                                            std::size_t count);

/// The poses of a CSV file, a line for each sensor rock: x_over_radius, y_over_radius,
/// z_over_height, qw, qx, qy, qz (a unit quaternion, principal axes to world). Throws InputError
/// with file:line.
std::vector<SmartRockPose> read_smart_rock_poses(const std::filesystem::path& csv,
                                                 const SensorRoom& room);

} // namespace bris
