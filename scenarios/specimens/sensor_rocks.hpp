#pragma once

#include "engine/math.hpp"

#include <filesystem>
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

/// Places ten sensor rocks at the interfaces of four lifts: at a quarter of the height one in the
/// centre and one beside the membrane; at one half and three quarters of the height one in the
/// centre and three beside the membrane, 120 degrees apart. `count`: 10, 7 or 3 (smart_rock_count).
/// The orientations are drawn from the seed.
std::vector<SmartRockPose> smart_rock_poses(const SensorRoom& room, std::uint64_t seed,
                                            std::size_t count);

/// Reads poses from a CSV file with a row for each sensor rock: x_over_radius, y_over_radius,
/// z_over_height, qw, qx, qy, qz (a unit quaternion, principal axes to world). Throws InputError
/// with file:line for a sensor rock outside the mould or too close to another one.
std::vector<SmartRockPose> read_smart_rock_poses(const std::filesystem::path& csv,
                                                 const SensorRoom& room);

} // namespace bris
